"""Rays that make an intersector fail: at random, at vertices and edges, grazing round surfaces."""

from __future__ import annotations

import numpy as np

from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.workload import CONE, POLYGON, SPHERE


def aimed_rays(geometry: Geometry, n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """n origins and unit directions (n, 3) float64, normalised; half of them start inside."""
    rng = np.random.default_rng(seed)
    box = np.where(np.isfinite(geometry.box), geometry.box, 0.0)
    centre, size = (box[:3] + box[3:]) / 2, np.linalg.norm(box[3:] - box[:3])
    spread = np.where(rng.random((n, 1)) < 0.5, 0.4, 2.0) * size
    origins = centre + rng.normal(size=(n, 3)) * spread
    targets = box[:3] + rng.random((n, 3)) * (box[3:] - box[:3])
    for start, aim in enumerate((_vertices, _edges, _grazing), start=1):
        some = slice(start * n // 4, (start + 1) * n // 4)
        targets[some] = aim(geometry, origins[some], targets[some], rng)
    directions = targets - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def _flat_rows(geometry: Geometry) -> np.ndarray:
    rows = np.maximum(geometry.n_triangles, 1)
    return geometry.shapes.surfaces[np.repeat(geometry.kinds >= POLYGON, rows)]


def _vertices(geometry, origins, targets, rng):
    rows = _flat_rows(geometry)
    if not len(rows):
        return targets
    rows = rows[rng.integers(len(rows), size=len(origins))]
    return rows[:, :3] + rng.integers(2, size=(len(origins), 1)) * rows[:, 3:6]


def _edges(geometry, origins, targets, rng):
    rows = _flat_rows(geometry)
    if not len(rows):
        return targets
    rows = rows[rng.integers(len(rows), size=len(origins))]
    return rows[:, :3] + rng.random((len(origins), 1)) * rows[:, 3:6]


def _grazing(geometry, origins, targets, rng):
    """Points beside a sphere or cylinder, its radius away across the ray, give or take 1e-6."""
    first = np.cumsum(np.maximum(geometry.n_triangles, 1)) - np.maximum(geometry.n_triangles, 1)
    rows = geometry.shapes.surfaces[first[geometry.kinds <= CONE]]
    kinds = geometry.kinds[geometry.kinds <= CONE]
    if not len(rows):
        return targets
    pick = rng.integers(len(rows), size=len(origins))
    rows, round_ = rows[pick], kinds[pick] == SPHERE
    radius = np.where(round_, rows[:, 3], rows[:, 7])[:, None]
    along = np.where(round_, 0.0, rng.random(len(origins)) * rows[:, 6])[:, None]
    axis = np.where(round_[:, None], rng.normal(size=(len(origins), 3)), rows[:, 3:6])
    centre = rows[:, :3] + along * axis
    aside = np.cross(centre - origins, axis)
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    return centre + aside * radius * (1 + rng.normal(size=(len(origins), 1)) * 1e-6)
