"""Many polygons cut into triangles at once: most are convex, and the same of all of one size."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.columns import POLYGON, Columns
from simmpp.scene.cut import Indices
from simmpp.scene.scene import Floats
from simmpp.scene.triangles import polygon_faces


def faces_of(objects: Columns) -> tuple[Indices, Indices]:
    """All triangles (m, 3) in the order of their objects, and (m,) the object of each."""
    of_parts = np.repeat(np.arange(len(objects.kinds)), objects.n_faces)
    is_polygon = objects.kinds == POLYGON
    if not is_polygon.any():
        return objects.faces, of_parts
    sizes = np.where(is_polygon, objects.n_vertices, 0)
    corners = np.flatnonzero(np.repeat(is_polygon, objects.n_vertices)).astype(np.int32)
    faces, owners = tiled(objects.vertices, sizes, corners)
    if not len(of_parts):
        return faces, owners
    owners = np.concatenate([owners, of_parts])
    order = np.argsort(owners, kind="stable")
    return np.concatenate([faces, objects.faces])[order], owners[order]


def tiled(vertices: Floats, sizes: Indices, corners: Indices) -> tuple[Indices, Indices]:
    """Triangles (k, 3) in the order of their polygons, and (k,) the polygon of each.

    Parameters
    ----------
    vertices : (n, 3) float64
    sizes : (m,) how many corners each polygon has; below 3 it is left out
    corners : (sum of sizes,) of any integers, which those of the triangles are, too
    """
    if np.all(sizes == 3):
        return corners.reshape(-1, 3), np.arange(len(sizes))
    faces, owners = [np.empty((0, 3), corners.dtype)], [np.empty(0, np.int64)]
    starts = np.cumsum(sizes) - sizes
    for size in np.unique(sizes[sizes >= 3]).tolist():
        numbers = np.flatnonzero(sizes == size)
        rows = corners[starts[numbers][:, None] + np.arange(size)]
        convex = _are_fans(vertices, rows)
        steps = np.arange(1, size - 1)
        fan = np.stack([np.zeros_like(steps), steps, steps + 1], axis=1)
        faces.append(rows[convex][:, fan].reshape(-1, 3))
        owners.append(np.repeat(numbers[convex], len(fan)))
        for number, row in zip(numbers[~convex], rows[~convex], strict=True):
            tiles = row[polygon_faces(vertices[row])]
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
