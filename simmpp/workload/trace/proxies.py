"""What embree gets: all triangles, and inscribed polyhedra that stand for spheres and cones.

They propose hits, the equations decide. Inscribed, because a ray that leaves a sphere must not be
stopped by its own proxy; what slips past a proxy hits something behind, which is a bound as well.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.workload import CONE, SPHERE

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Number = TypeVar("Number", bound=np.generic)

SIDES = 3
"""Sides of the prism in a cone. More triangles, in spheres too, propose more of the hits (a
tetrahedron is met by 37 % of the rays that meet its sphere, an icosahedron by 76 %), but no trace
got faster by that, and embree needs a microsecond for each."""


def proxy_mesh(geometry: Geometry) -> tuple[NDArray[np.float32], Ints, Ints]:
    """All triangles embree gets, and what each stands for.

    Returns
    -------
    vertices : (n, 3) float32, normalised
    faces : (m, 3) int32 into them
    stands_for : (m, 2) int32, object and row of the triangle; row -1 for spheres and cones
    """
    n_rows = np.maximum(geometry.n_triangles, 1)
    last = np.cumsum(n_rows) - 1
    flat_rows = np.flatnonzero(np.repeat(geometry.n_triangles > 0, n_rows))
    owners = [np.repeat(np.arange(len(n_rows)), geometry.n_triangles)]
    vertices, faces = [geometry.vertices], [geometry.faces]
    n_vertices = len(geometry.vertices)
    for kind, corners_of, sides in ((SPHERE, _in_spheres, TETRAHEDRON), (CONE, _in_cones, PRISM)):
        numbers = np.flatnonzero(geometry.kinds == kind)
        if not len(numbers):
            continue
        corners = corners_of(geometry.shapes.surfaces[last[numbers]])
        starts = n_vertices + corners.shape[1] * np.arange(len(numbers))
        vertices.append(corners.reshape(-1, 3).astype(np.float32))
        faces.append((starts[:, None, None] + sides).reshape(-1, 3).astype(np.int32))
        owners.append(np.repeat(numbers, len(sides)))
        n_vertices += len(vertices[-1])
    stands_for = np.full((sum(map(len, faces)), 2), -1, dtype=np.int32)
    stands_for[:, 0] = np.concatenate(owners)
    stands_for[: len(flat_rows), 1] = flat_rows
    return _joined(vertices), _joined(faces), stands_for


def _joined(parts: list[NDArray[Number]]) -> NDArray[Number]:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


CORNERS = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / math.sqrt(3)
TETRAHEDRON = np.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)], np.int32)
_LOW, _NEXT = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES
PRISM = np.concatenate(
    [
        np.stack([_LOW, _NEXT, SIDES + _LOW], axis=1),
        np.stack([SIDES + _LOW, _NEXT, SIDES + _NEXT], axis=1),
    ]
)
"""(6, 3): its vertices are those around the base, then those around the apex."""


def _in_spheres(shapes: Floats) -> Floats:
    """(n, 4, 3) float64."""
    corners: Floats = shapes[:, None, 3:4] * CORNERS + shapes[:, None, :3]
    return corners


def _in_cones(shapes: Floats) -> Floats:
    """Open prisms, (n, 6, 3); around each axis from two directions across it."""
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
    return np.concatenate([low, high], axis=1)
