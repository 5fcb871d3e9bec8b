"""Flat faces: triangles joined to quadrilaterals where they make one, and cut in halves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
FLAT = 1e-9
"""Two triangles are one quadrilateral if the sine between them is below this, and that of none of
its corners. A face whose area is below this share of its longest side's square has none."""


class Faces(NamedTuple):
    """n triangles and convex quadrilaterals, counter-clockwise."""

    points: Floats
    """(n, 4, 3) float64; of a triangle the last is of no meaning."""
    is_quad: NDArray[np.bool_]
    """(n,) bool."""
    parts: Ints
    """(n,) int64: what each is of."""

    def of(self, chosen: NDArray[np.generic]) -> Faces:
        """Some of them."""
        return Faces._make(column[chosen] for column in self)


def joined(triangles: Faces) -> Faces:
    """The same with each triangle joined to the next if both make a flat, convex quadrilateral."""
    joins, quads = _pairs(triangles.points[:, :3], triangles.parts)
    n, taken = len(triangles.parts), False
    begins = np.zeros(n, np.bool_)
    for k, can in enumerate(joins.tolist()):  # a triangle is of one quadrilateral only
        begins[k] = taken = can and not taken
    points, is_kept = triangles.points.copy(), np.ones(n, np.bool_)
    points[begins] = quads[begins[:-1]]
    is_kept[1:] = ~begins[:-1]
    return Faces(points, begins, triangles.parts).of(is_kept)


def _pairs(points: Floats, parts: Ints) -> tuple[NDArray[np.bool_], Floats]:
    """Which triangles make a quadrilateral with the next, and its corners (n - 1, 4, 3)."""
    one, other = points[:-1], points[1:]
    same = (one[:, :, None] == other[:, None]).all(axis=3)
    alone, apart = same.any(axis=2).argmin(axis=1), same.any(axis=1).argmin(axis=1)
    rows = np.arange(len(one))
    begin = [one[rows, (alone + k) % 3] for k in range(3)]
    far = [other[rows, (apart + k) % 3] for k in range(3)]
    # The common edge is gone along both ways: first of one is last of the other.
    shares = (begin[1] == far[2]).all(axis=1) & (begin[2] == far[1]).all(axis=1)
    quads = np.stack([begin[2], begin[0], begin[1], far[0]], axis=1)
    ahead = np.roll(quads, -1, axis=1) - quads
    turns = np.cross(np.roll(ahead, 1, axis=1), ahead)
    lengths = np.linalg.norm(ahead, axis=2)
    sizes = lengths * np.roll(lengths, 1, axis=1)
    normal = turns.sum(axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
    upright = (turns * normal[:, None]).sum(axis=2)
    tilted = np.linalg.norm(turns - upright[:, :, None] * normal[:, None], axis=2)
    fits = (upright > FLAT * sizes).all(axis=1) & (tilted <= FLAT * sizes).all(axis=1)
    joins: NDArray[np.bool_] = shares & fits & (parts[:-1] == parts[1:])
    return joins, quads


def halved(faces: Faces, large: NDArray[np.bool_]) -> Faces:
    """The ``large`` ones cut in two, each half in the place of the whole."""
    rows = np.repeat(np.arange(len(large)), np.where(large, 2, 1))
    cut = faces.of(rows)
    is_second = np.concatenate([[False], rows[1:] == rows[:-1]])
    is_first = np.concatenate([is_second[1:], [False]])
    one, other = _halves(faces.points[large], faces.is_quad[large])
    cut.points[is_first], cut.points[is_second] = one, other
    return cut


def _halves(points: Floats, is_quad: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Both halves (n, 4, 3): across the longer two sides, or from the middle of the longest."""
    rows = np.arange(len(points))[:, None]
    quad_sides = lengths(np.roll(points, -1, axis=1) - points)
    across = quad_sides[:, 1] + quad_sides[:, 3] > quad_sides[:, 0] + quad_sides[:, 2]
    ahead = np.concatenate([points[:, 1:3], points[:, :1]], axis=1)
    longest = lengths(ahead - points[:, :3]).argmax(axis=1)
    turn = np.where(is_quad, across.astype(np.int64), longest)
    size = np.where(is_quad, 4, 3)[:, None]
    a, b, c, d = np.moveaxis(points[rows, (turn[:, None] + np.arange(4)) % size], 1, 0)
    near, far = (a + b) / 2, (c + d) / 2
    of_quads = np.stack([a, near, far, d], axis=1), np.stack([near, b, c, far], axis=1)
    of_triangles = np.stack([a, near, c, c], axis=1), np.stack([near, b, c, c], axis=1)
    choose = is_quad[:, None, None]
    return (
        np.where(choose, of_quads[0], of_triangles[0]),
        np.where(choose, of_quads[1], of_triangles[1]),
    )


def areas_of(faces: Faces) -> Floats:
    """(n,) float64; of a flat quadrilateral half the product of its diagonals."""
    points = faces.points
    a = np.where(faces.is_quad[:, None], points[:, 2] - points[:, 0], points[:, 1] - points[:, 0])
    b = np.where(faces.is_quad[:, None], points[:, 3] - points[:, 1], points[:, 2] - points[:, 0])
    areas: Floats = lengths(np.cross(a, b)) / 2
    return areas


def lengths(vectors: Floats) -> Floats:
    """Sums of products only, so that every CPU gives the same bits."""
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    lengths: Floats = np.sqrt(x * x + y * y + z * z)
    return lengths
