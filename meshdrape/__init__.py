"""meshdrape."""
