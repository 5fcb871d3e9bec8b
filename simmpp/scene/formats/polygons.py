"""Polygons that share vertices, checked and cut into triangles: what all these formats hold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from simmpp.scene.cut import Indices
from simmpp.scene.formats.text import Line, Source
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.node import are_usable
from simmpp.scene.scene import Floats
from simmpp.scene.tiling import tiled


class Polygons(NamedTuple):
    """Polygons by the indices of their vertices, and the lines that both stand in."""

    vertices: Floats
    """(n, 3) float64."""
    sizes: Indices
    """(m,) int64: how many vertices each polygon has; below 3 it is a line or a point, left out."""
    corners: Indices
    """(sum of sizes,) of any whole numbers, into ``vertices``, counted from 0."""
    vertex_line: Line
    polygon_line: Line


def triangulated(polygons: Polygons, source: Source) -> tuple[Indices, Indices]:
    """Triangles (k, 3) int32 in the order of their polygons, and (k,) the polygon of each.

    Raises SceneError for a polygon that names no vertex, or one that is not finite.
    """
    _check(polygons, source)
    return tiled(polygons.vertices, polygons.sizes, polygons.corners.astype(np.int32))


def _check(polygons: Polygons, source: Source) -> None:
    vertices, corners, n = polygons.vertices, polygons.corners, len(polygons.vertices)
    if len(corners) and not 0 <= corners.min() <= corners.max() < n:
        corner = int(((corners < 0) | (corners >= n)).argmax())
        polygon = int(np.searchsorted(np.cumsum(polygons.sizes), corner, side="right"))
        problem = f"face {polygon + 1} names vertex {corners[corner]}, expected 0 to {n - 1}"
        raise source.error(problem, polygons.polygon_line(polygon))
    if are_usable(vertices):
        return
    wild = ~np.all(np.abs(vertices) <= LARGEST, axis=1)
    used = corners[wild[corners]]
    if len(used):
        vertex = int(used[0])
        numbers = ", ".join(f"{x:g}" for x in vertices[vertex])
        problem = f"vertex {vertex + 1} ({numbers}) is not a finite number of at most {LARGEST:g}"
        raise source.error(problem, polygons.vertex_line(vertex))
