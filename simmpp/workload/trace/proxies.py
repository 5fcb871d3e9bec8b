"""Inscribed polyhedra that stand for spheres and cones in embree, which knows triangles only.

They propose hits, the equations decide. Inscribed, because a ray that leaves a sphere must not be
stopped by its own proxy; what slips past a proxy hits something behind, which is a bound as well.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.trace.geometry import Geometry, corners_of
from simmpp.workload.workload import CONE, SPHERE

Floats = NDArray[np.float64]

SIDES = 8
"""Sides of the prism in a cone: 16 triangles, as many as embree tests at little cost."""


def proxy_mesh(geometry: Geometry) -> tuple[Floats, NDArray[np.int32]]:
    """All triangles embree gets, and what each stands for.

    Returns
    -------
    corners : (n, 3, 3) float64, normalised
    stands_for : (n, 2) int32, object and row of the triangle; row -1 for spheres and cones
    """
    spheres = np.flatnonzero(geometry.kinds == SPHERE)
    cones = np.flatnonzero(geometry.kinds == CONE)
    rows = geometry.shapes.surfaces
    row_counts = np.maximum(geometry.n_triangles, 1)
    flat_rows = np.flatnonzero(np.repeat(geometry.n_triangles > 0, row_counts))
    first = np.cumsum(row_counts) - row_counts
    corners = [corners_of(rows[flat_rows])]
    corners += [_in_spheres(rows[first[spheres]]), _in_cones(rows[first[cones]])]
    owners = [np.repeat(np.arange(len(row_counts)), geometry.n_triangles)]
    owners += [np.repeat(spheres, len(ICOSAHEDRON)), np.repeat(cones, 2 * SIDES)]
    stands_for = np.full((sum(map(len, corners)), 2), -1, dtype=np.int32)
    stands_for[:, 0] = np.concatenate(owners)
    stands_for[: len(flat_rows), 1] = flat_rows
    return np.concatenate(corners), stands_for


def _icosahedron() -> Floats:
    """(20, 3, 3) float64 inscribed in the unit sphere: faces of mutually nearest vertices."""
    golden = (1 + math.sqrt(5)) / 2
    signs = [(s, t * golden) for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    vertices = np.array([np.roll((0.0, s, t), axis) for axis in range(3) for s, t in signs])
    near = np.abs(((vertices[:, None] - vertices[None]) ** 2).sum(axis=2) - 4.0) < 1e-9
    faces = [
        (i, j, k)
        for i in range(12)
        for j in range(i)
        for k in range(j)
        if near[i, j] and near[j, k] and near[i, k]
    ]
    corners: Floats = vertices[np.array(faces)] / math.hypot(1.0, golden)
    return corners


ICOSAHEDRON = _icosahedron()


def _in_spheres(shapes: Floats) -> Floats:
    corners = shapes[:, None, None, 3:4] * ICOSAHEDRON + shapes[:, None, None, :3]
    return corners.reshape(-1, 3, 3)


def _in_cones(shapes: Floats) -> Floats:
    """Open prisms; around each axis from two directions across it."""
    base, axis, height, radius, growth = np.split(shapes, (3, 6, 7, 8), axis=1)
    # Any vector across will do, if the cross product with the axis is not small.
    aside = np.where(np.abs(axis[:, :1]) < 0.5, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    right = np.cross(axis, aside)
    right /= np.sqrt((right**2).sum(axis=1, keepdims=True))
    angles = np.arange(SIDES) * (2 * math.pi / SIDES)
    around = (
        np.cos(angles)[None, :, None] * right[:, None]
        + np.sin(angles)[None, :, None] * np.cross(axis, right)[:, None]
    )
    low = base[:, None] + radius[:, None] * around
    high = (base + height * axis)[:, None] + (radius + growth * height)[:, None] * around
    next_low, next_high = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    halves = [
        np.stack([low, next_low, high], axis=2),
        np.stack([high, next_low, next_high], axis=2),
    ]
    return np.stack(halves, axis=2).reshape(-1, 3, 3)
