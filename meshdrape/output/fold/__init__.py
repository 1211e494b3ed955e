"""The answer of `meshdrape fold`: text, charts, page."""
