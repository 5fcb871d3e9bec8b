"""Rays of a scene: Embree proposes, float64 decides."""
