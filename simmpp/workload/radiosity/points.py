"""Where rays leave patches, where to, and where they land.

A patch has two sides, each with light of its own: side 2 i is the front of patch i, which its
corners go round counter-clockwise, side 2 i + 1 its back.

Ray k of the n of a shot has point k of a Hammersley set in four dimensions (k / n and the digits
of k mirrored in bases 2, 3 and 5), shifted by four numbers drawn for the side and the shot (Cranley
and Patterson 1976). Two dimensions are its direction, by Lambert's cosine, two the point.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.scene.scene import Vector
from simmpp.workload.particles.functions import cosine, sine
from simmpp.workload.trace.exact import row_of
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.path.philox import numbers
from simmpp.workload.trace.ray_batch import RayBatch, unwritten
from simmpp.workload.trace.vectors import basis_across, cross, dot, moved, normalised, times, vector
from simmpp.workload.workload import FORM_FACTOR

Ints = NDArray[np.int64]
SHIFT = 5
"""Dimension of the numbers that shift a shot's points; those of paths are below."""


def leaving(geometry: Geometry, sides: Ints, counts: Ints, shots: Ints, seed: int) -> RayBatch:
    """``counts`` rays of each of some ``sides``, each the shot of that number."""
    rays = unwritten(int(counts.sum()))
    rays.kinds[:], rays.limits[:], rays.parents[:] = FORM_FACTOR, np.inf, -1
    rays.roots[:] = np.arange(len(rays.roots))  # nobody reads them
    _aim(geometry, sides, counts, shots, seed, rays)
    return rays


@njit
def _aim(
    geometry: Geometry, sides: Ints, counts: Ints, shots: Ints, seed: int, rays: RayBatch
) -> None:
    i = 0
    for place in range(len(sides)):
        side, n = sides[place], counts[place]
        patch = side // 2
        normal = times(1.0 - 2.0 * (side % 2), vector(geometry.normals, patch))
        across, along = basis_across(normal)
        shift = numbers(seed, side, shots[place], SHIFT)
        for k in range(n):
            x, y = disc(shifted(k / n, shift[0]), shifted(mirrored(k, 2), shift[1]))
            up = math.sqrt(max(0.0, 1.0 - (x * x + y * y)))
            ahead = normalised(moved(moved(times(up, normal), x, across), y, along))
            u, v = shifted(mirrored(k, 3), shift[2]), shifted(mirrored(k, 5), shift[3])
            point = _point_of(geometry, patch, u, v)
            rays.origins[i, 0], rays.origins[i, 1], rays.origins[i, 2] = point
            rays.directions[i, 0], rays.directions[i, 1], rays.directions[i, 2] = ahead
            rays.sources[i] = patch
            i += 1


def landed(geometry: Geometry, rays: RayBatch, hits: NDArray[np.int32]) -> Ints:
    """(n,) int64: the side that each ray lands on; -1 for none."""
    places = np.empty(len(hits), np.int64)
    _land(geometry, rays, hits, places)
    return places


@njit
def _land(geometry: Geometry, rays: RayBatch, hits: NDArray[np.int32], places: Ints) -> None:
    for i in range(len(hits)):
        places[i] = -1
        if hits[i] >= 0:
            ahead, normal = vector(rays.directions, i), vector(geometry.normals, hits[i])
            places[i] = 2 * hits[i] + (1 if dot(ahead, normal) > 0.0 else 0)


@kernel
def _point_of(geometry: Geometry, patch: int, u: float, v: float) -> Vector:
    """A point of a patch, even where u and v are: in one of its triangles, by their areas."""
    row, end = geometry.shapes.objects[patch, 1], geometry.shapes.objects[patch, 2]
    if end - row > 1:
        one, other = _area_of(geometry, row), _area_of(geometry, row + 1)
        share = one / (one + other)
        if u < share:
            u /= share
        else:
            u, row = (u - share) / (1.0 - share), row + 1
    triangle = row_of(geometry.shapes.surfaces, row)
    reach = math.sqrt(u)
    along = v * reach
    return moved(moved(triangle[:3], reach - along, triangle[3:6]), along, triangle[6:])


@kernel
def _area_of(geometry: Geometry, row: int) -> float:
    """Twice the area of a triangle."""
    triangle = row_of(geometry.shapes.surfaces, row)
    across = cross(triangle[3:6], triangle[6:])
    return math.sqrt(dot(across, across))


@kernel
def shifted(x: float, by: float) -> float:
    """From 0 to below 1, round and round."""
    x += by
    return x - 1.0 if x >= 1.0 else x


@kernel
def mirrored(k: int, base: int) -> float:
    """The digits of ``k`` behind the point, the last one first (van der Corput)."""
    value, step = 0.0, 1.0 / base
    while k > 0:
        value += step * (k % base)
        k //= base
        step /= base
    return value


@kernel
def disc(u: float, v: float) -> tuple[float, float]:
    """An even point of the disc for one of the square, neighbours for neighbours.

    Shirley and Chiu 1997, "A low distortion map between disk and square".
    """
    a, b = 2.0 * u - 1.0, 2.0 * v - 1.0
    if a == 0.0 and b == 0.0:
        return 0.0, 0.0
    if abs(a) > abs(b):
        turn = b / a * (math.pi / 4)
        return a * cosine(turn), a * sine(turn)
    turn = a / b * (math.pi / 4)
    return b * sine(turn), b * cosine(turn)
