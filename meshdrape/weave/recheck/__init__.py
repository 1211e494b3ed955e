"""A finished net checked again by other means than those that made it."""
