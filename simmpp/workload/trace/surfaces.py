"""Surfaces of a scene in its frame, a row of nine numbers each: what is intersected exactly."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.scene.columns import CONE, POLYGON, SPHERE, Columns
from simmpp.scene.tiling import faces_of
from simmpp.workload.trace.frame import Frame

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

SLIVER = 1e-14
"""A triangle whose sine of the angle between two edges is below this has no area."""
PADDING = 2.0**-46
"""Boxes grow by this share of their diagonal and distance from the origin: 64 roundings, so that a
ray that hits a flat object also enters its box."""


class Surfaces(NamedTuple):
    """Rows of N objects, one object after the other."""

    rows: Floats
    """(rows, 9) float64: see ``Shapes.surfaces``."""
    n_rows: Ints
    """(N,) int32: 1 for spheres and cones."""
    vertices: Floats
    """(n, 3) float64: corners of the triangles ..."""
    faces: Ints
    """(m, 3) int32: ... and which each has, in the order of the rows."""


def surfaces_of(objects: Columns, frame: Frame) -> Surfaces:
    """The surfaces of objects in ``frame``."""
    vertices, (corners, owners) = frame.points(objects.vertices), faces_of(objects)
    n_rows = np.bincount(owners, minlength=len(objects.kinds)).astype(np.int32)
    n_rows[objects.kinds < POLYGON] = 1
    after = np.cumsum(n_rows, dtype=np.int32)
    rows = np.empty((n_rows.sum(), 9))
    rows[after[objects.kinds == SPHERE] - 1] = _spheres(objects.spheres, frame)
    rows[after[objects.kinds == CONE] - 1] = _cones(objects.cones, frame)
    # Only what is of one type may be passed: another would be compiled once more.
    faces: Ints = np.require(corners, np.int32, ["C", "W"])
    _fill_triangles(objects.kinds, after - n_rows, after, vertices, faces, rows)
    return Surfaces(rows, n_rows, vertices, faces)


def _spheres(spheres: Floats, frame: Frame) -> Floats:
    rows = np.zeros((len(spheres), 9))
    rows[:, :3] = frame.points(spheres[:, :3])
    rows[:, 3] = np.abs(spheres[:, 3]) * frame.scale
    return rows


def _cones(cones: Floats, frame: Frame) -> Floats:
    """Rows of cones; height 0 if one has no surface."""
    base, apex = frame.points(cones[:, :3]), frame.points(cones[:, 4:7])
    radius, apex_radius = np.abs(cones[:, 3::4]).T * frame.scale
    height = np.sqrt(((apex - base) ** 2).sum(axis=1))
    # Two points apart in the scene may be one here, where both have lost their last digits.
    is_none = (height == 0.0) | (np.maximum(radius, apex_radius) == 0.0)
    length = np.where(is_none, 1.0, height)
    axis, growth = (apex - base) / length[:, None], (apex_radius - radius) / length
    axis[is_none], height[is_none], growth[is_none] = (0.0, 0.0, 1.0), 0.0, 0.0
    return np.column_stack([base, axis, height, radius, growth])


@njit
def _fill_triangles(
    kinds: NDArray[np.uint8], first: Ints, after: Ints, vertices: Floats, faces: Ints, rows: Floats
) -> None:
    """The rows of polygons and meshes: a vertex and the two edges from it."""
    face = 0
    for i in range(len(kinds)):
        if kinds[i] < POLYGON:
            continue
        for k in range(first[i], after[i]):
            a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
            for axis in range(3):
                rows[k, axis] = vertices[a, axis]
                rows[k, 3 + axis] = vertices[b, axis] - vertices[a, axis]
                rows[k, 6 + axis] = vertices[c, axis] - vertices[a, axis]
            # Edges of 0 make a determinant of 0: never hit, whatever direction roundings gave the
            # sliver.
            if _is_sliver(rows, k):
                rows[k, 3:] = 0.0
            face += 1


@kernel
def _is_sliver(rows: Floats, k: int) -> bool:
    a, b, c, u, v, w = rows[k, 3], rows[k, 4], rows[k, 5], rows[k, 6], rows[k, 7], rows[k, 8]
    x, y, z = b * w - c * v, c * u - a * w, a * v - b * u
    lengths = np.sqrt(a * a + b * b + c * c) * np.sqrt(u * u + v * v + w * w)
    return np.sqrt(x * x + y * y + z * z) <= SLIVER * lengths


def normals_of(kinds: NDArray[np.uint8], surfaces: Surfaces) -> Floats:
    """Unit normals (N, 3) of polygons: sums of area vectors, right even at a concave corner."""
    normals, flat = np.zeros((len(kinds), 3)), kinds == POLYGON
    if flat.any():
        rows, sizes = surfaces.rows[np.repeat(flat, surfaces.n_rows)], surfaces.n_rows[flat]
        areas = np.cross(rows[:, 3:6], rows[:, 6:])
        normals[flat] = np.add.reduceat(areas, np.cumsum(sizes) - sizes)
    lengths = np.sqrt((normals**2).sum(axis=1, keepdims=True))
    return normals / np.where(lengths > 0, lengths, 1.0)  # without area it is never hit


def boxes_of(kinds: NDArray[np.uint8], surfaces: Surfaces) -> Floats:
    """Tight boxes (N, 6) float64."""
    boxes, spheres, cones = np.empty((len(kinds), 6)), kinds == SPHERE, kinds == CONE
    after = np.cumsum(surfaces.n_rows, dtype=np.int32)
    centre, radius = np.split(surfaces.rows[after[spheres] - 1, :4], (3,), axis=1)
    boxes[spheres] = np.hstack([centre - radius, centre + radius])
    boxes[cones] = _cone_boxes(surfaces.rows[after[cones] - 1])
    _fill_boxes(kinds, after - surfaces.n_rows, after, surfaces.rows, boxes)
    return boxes


@njit
def _fill_boxes(
    kinds: NDArray[np.uint8], first: Ints, after: Ints, rows: Floats, boxes: Floats
) -> None:
    """The boxes of polygons and meshes."""
    for i in range(len(kinds)):
        if kinds[i] < POLYGON:
            continue
        for axis in range(3):
            boxes[i, axis], boxes[i, 3 + axis] = np.inf, -np.inf
        for k in range(first[i], after[i]):
            for axis in range(3):
                low, high = _interval(rows, k, axis)
                boxes[i, axis] = min(boxes[i, axis], low)
                boxes[i, 3 + axis] = max(boxes[i, 3 + axis], high)


@kernel
def _interval(rows: Floats, k: int, axis: int) -> tuple[float, float]:
    """Where a triangle begins and ends along an axis, as intersections see it."""
    # Not as the scene has it: vertex + (corner - vertex) may be rounded to another number.
    a = rows[k, axis]
    b, c = a + rows[k, 3 + axis], a + rows[k, 6 + axis]
    return min(a, b, c), max(a, b, c)


def row_boxes(rows: Floats, spans: NDArray[np.int64]) -> Floats:
    """Padded boxes (rows, 6) of the triangles in ``spans``; of others, nothing is written."""
    boxes = np.empty((len(rows), 6))
    _fill_row_boxes(rows, spans, boxes)
    return boxes


@njit
def _fill_row_boxes(rows: Floats, spans: NDArray[np.int64], boxes: Floats) -> None:
    """:func:`padded` of triangle after triangle."""
    for span in range(len(spans)):
        for k in range(spans[span, 0], spans[span, 1]):
            reach, square = 0.0, 0.0
            for axis in range(3):
                low, high = _interval(rows, k, axis)
                boxes[k, axis], boxes[k, 3 + axis] = low, high
                reach = max(reach, abs(low), abs(high))
                square += (high - low) * (high - low)
            grow = PADDING * (np.sqrt(square) + reach)
            for axis in range(3):
                boxes[k, axis] -= grow
                boxes[k, 3 + axis] += grow


def padded(boxes: Floats) -> Floats:
    """Boxes (n, 6) float64 grown by PADDING."""
    low, high = boxes[:, :3], boxes[:, 3:]
    # Slab tests subtract the origin from a bound, so they round by a share of where the box lies,
    # and intersections by a share of how large its object is: either may be the larger.
    reach = np.abs(boxes).max(axis=1, initial=0.0)
    grow = PADDING * (np.sqrt(((high - low) ** 2).sum(axis=1)) + reach)[:, None]
    return np.hstack([low - grow, high + grow])


def _cone_boxes(cones: Floats) -> Floats:
    """Boxes of the two rims of each cone (n, 9): a disc reaches r sqrt(1 - axis^2) to each side.

    1 - axis^2 is the sum of the other two squares: a difference would lose half the digits.
    """
    base, axis, height, radius, growth = np.split(cones, (3, 6, 7, 8), axis=1)
    reach = np.sqrt(axis[:, [1, 0, 0]] ** 2 + axis[:, [2, 2, 1]] ** 2)
    apex, apex_radius = base + height * axis, radius + height * growth
    low = np.minimum(base - radius * reach, apex - apex_radius * reach)
    high = np.maximum(base + radius * reach, apex + apex_radius * reach)
    return np.hstack([low, high])
