"""Paths and distances on a surface, exact on the polyhedron."""

from meshdrape.geodesic.distance import geodesic_distance, surface_distance

__all__ = ["geodesic_distance", "surface_distance"]
