"""The seed point, and the two start fibres through it, straight, turned or drawn."""
