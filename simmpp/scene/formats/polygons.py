"""Polygons that share vertices, checked and cut into triangles: what all these formats hold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.cut import Indices
from simmpp.scene.formats.text import Line, Source
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.scene import Floats
from simmpp.scene.triangles import polygon_faces


class Polygons(NamedTuple):
    """Polygons by the indices of their vertices, and the lines that both stand in."""

    vertices: Floats
    """(n, 3) float64."""
    sizes: Indices
    """(m,) int64: how many vertices each polygon has; below 3 it is a line or a point, left out."""
    corners: Indices
    """(sum of sizes,) int64 into ``vertices``, counted from 0."""
    vertex_line: Line
    polygon_line: Line


def triangulated(polygons: Polygons, source: Source) -> tuple[Indices, Indices]:
    """Triangles (k, 3) int64 in the order of their polygons, and (k,) the polygon of each.

    Raises SceneError for a polygon that names no vertex, or one that is not finite.
    """
    _check(polygons, source)
    if np.all(polygons.sizes == 3):
        return polygons.corners.reshape(-1, 3), np.arange(len(polygons.sizes))
    faces, owners = [np.empty((0, 3), np.int64)], [np.empty(0, np.int64)]
    starts = np.cumsum(polygons.sizes) - polygons.sizes
    for size in np.unique(polygons.sizes[polygons.sizes >= 3]).tolist():
        numbers = np.flatnonzero(polygons.sizes == size)
        corners = polygons.corners[starts[numbers][:, None] + np.arange(size)]
        convex = _are_fans(polygons.vertices, corners)
        steps = np.arange(1, size - 1)
        fan = np.stack([np.zeros_like(steps), steps, steps + 1], axis=1)
        faces.append(corners[convex][:, fan].reshape(-1, 3))
        owners.append(np.repeat(numbers[convex], len(fan)))
        for number, row in zip(numbers[~convex], corners[~convex], strict=True):
            tiles = row[polygon_faces(polygons.vertices[row])]
            faces.append(tiles)
            owners.append(np.full(len(tiles), number))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(faces)[order], owner[order]


def _are_fans(vertices: Floats, corners: Indices) -> NDArray[np.bool_]:
    """Which polygons (k, n) need not be looked at one by one."""
    n_polygons, size = corners.shape
    if size == 3:
        return np.ones(n_polygons, dtype=np.bool_)
    if size > n_polygons:  # arrays don't pay, and a polygon may have a million corners
        return np.zeros(n_polygons, dtype=np.bool_)
    return are_convex(vertices[corners])


def are_convex(points: Floats) -> NDArray[np.bool_]:
    """Which polygons (k, n, 3) are surely convex: ``triangles.polygon_faces`` for many at once.

    The same sums in the same order, so that both find the same.
    """
    spokes = points - points[:, :1]
    points = np.ldexp(spokes, -np.frexp(np.abs(spokes).max(axis=(1, 2), keepdims=True))[1])
    n = points.shape[1]
    area = np.zeros((len(points), 3))
    for i in range(n):
        area += _cross(points[:, i], points[:, (i + 1) % n])
    widest = np.abs(area).argmax(axis=1)
    axes = np.array([(1, 2), (2, 0), (0, 1)])[widest]
    flat = np.take_along_axis(points, axes[:, None], axis=2)
    a, b, c = np.roll(flat, 2, axis=1), np.roll(flat, 1, axis=1), flat
    left, right = b - a, c - a
    turns = left[..., 0] * right[..., 1] - left[..., 1] * right[..., 0]
    convex: NDArray[np.bool_] = (turns.min(axis=1) >= 0) | (turns.max(axis=1) <= 0)
    return convex


def _cross(a: Floats, b: Floats) -> Floats:
    """The cross products of rows, each difference as it is written in ``triangles``."""
    products: Floats = a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]
    return products


def _check(polygons: Polygons, source: Source) -> None:
    vertices, corners, n = polygons.vertices, polygons.corners, len(polygons.vertices)
    outside = (corners < 0) | (corners >= n)
    if outside.any():
        corner = int(outside.argmax())
        polygon = int(np.searchsorted(np.cumsum(polygons.sizes), corner, side="right"))
        problem = f"face {polygon + 1} names vertex {corners[corner]}, expected 0 to {n - 1}"
        raise source.error(problem, polygons.polygon_line(polygon))
    wild = ~np.all(np.abs(vertices) <= LARGEST, axis=1)
    used = corners[wild[corners]] if wild.any() else corners[:0]
    if len(used):
        vertex = int(used[0])
        numbers = ", ".join(f"{x:g}" for x in vertices[vertex])
        problem = f"vertex {vertex + 1} ({numbers}) is not a finite number of at most {LARGEST:g}"
        raise source.error(problem, polygons.vertex_line(vertex))
