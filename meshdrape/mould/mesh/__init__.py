"""Whether a triangle mesh can be draped, and on request its repair."""
