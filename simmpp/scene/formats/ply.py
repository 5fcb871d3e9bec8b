"""PLY: polygons and triangle strips of one mesh, in text or in binary of either byte order.

The colour is the mean of the vertices' or faces' colours. Elements and properties of other names
are skipped, as the format means it.
"""

from __future__ import annotations

import codecs
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.formats.colours import as_bytes, matt
from simmpp.scene.formats.ply_body import Body, Column, body_of, read_element
from simmpp.scene.formats.ply_header import read_header
from simmpp.scene.formats.polygons import Polygons, triangulated
from simmpp.scene.formats.text import Source
from simmpp.scene.node import Node
from simmpp.scene.scene import Floats, Material

POSITION, COLOUR = ("x", "y", "z"), ("red", "green", "blue")
CORNERS = ("vertex_indices", "vertex_index")
WANTED = {*POSITION, *COLOUR, *CORNERS}
NONE = np.empty(0, np.int64)
Columns = Mapping[str, Column]
"""Of an element, by the names of its properties."""


def nodes(data: bytes, file: Path) -> list[Node]:
    """The mesh of a PLY file."""
    source = Source(file, "ply")
    data = data.removeprefix(codecs.BOM_UTF8)
    header = read_header(data, source)
    body = body_of(data, header, source)
    elements: dict[str, Columns] = {}
    end = 0
    for element in header.elements:
        elements[element.name], end = read_element(body, element, end, WANTED, source)
    if not body.is_blank(end):
        raise source.error("after the last row that the header says there is more", body.line(end))
    polygons = _polygons(elements, body, source)
    faces, _ = triangulated(polygons, source)
    return [Node(file.name, polygons.vertices, faces, _surface(elements))]


def _polygons(elements: Mapping[str, Columns], body: Body, source: Source) -> Polygons:
    """Faces, then the triangles of strips."""
    vertex = elements.get("vertex", {})
    positions = _numbers(vertex, POSITION)
    if positions is None:
        raise source.error("expected an element vertex with the numbers x, y and z")
    lists = []
    if "face" in elements:
        lists.append(_corners("face", elements, source))
    if "tristrips" in elements:
        lists.append(_triangles(_corners("tristrips", elements, source)))
    faces = lists[0] if len(lists) == 1 else _one_after_the_other(lists)
    return Polygons(
        positions.astype(np.float64),
        faces.sizes,
        faces.values,
        lambda i: body.line(vertex["x"].starts[i]),
        lambda i: body.line(faces.starts[i]),
    )


def _one_after_the_other(lists: list[Column]) -> Column:
    starts, sizes = (
        np.concatenate([NONE, *(np.asarray(column[field]) for column in lists)]) for field in (1, 2)
    )
    values = [column.values.astype(np.int64) for column in lists]
    return Column(True, starts, sizes, np.concatenate([NONE, *values]))


def _corners(name: str, elements: Mapping[str, Columns], source: Source) -> Column:
    """The lists of vertices of all faces, or strips."""
    column = next((elements[name][key] for key in CORNERS if key in elements[name]), None)
    if column is None or not column.is_list or column.values.dtype.kind == "f":
        raise source.error(f"expected an element {name} with a list {CORNERS[0]} of whole numbers")
    return column


def _triangles(strips: Column) -> Column:
    """Every three vertices in a row, each second time the other way round; -1 begins anew."""
    corners = strips.values.astype(np.int64)
    place = np.arange(len(corners))
    begin = np.where(corners == -1, place + 1, 0)
    filled = strips.sizes > 0
    firsts = (np.cumsum(strips.sizes) - strips.sizes)[filled]
    begin[firsts] = np.maximum(begin[firsts], firsts)
    begin = np.maximum.accumulate(begin)[2:]
    rows = np.flatnonzero(begin <= place[:-2])
    faces = corners[rows[:, None] + np.arange(3)]
    odd = (rows - begin[rows]) % 2 == 1
    faces[odd] = faces[odd][:, [1, 0, 2]]
    is_turn = (faces == np.roll(faces, 1, axis=1)).any(axis=1)  # of the strip: two are the same
    faces, rows = faces[~is_turn], rows[~is_turn]
    starts = np.repeat(strips.starts, strips.sizes)[rows]
    return Column(True, starts, np.full(len(faces), 3), faces.ravel())


def _surface(elements: Mapping[str, Columns]) -> Material:
    for name in ("vertex", "face"):
        colours = _numbers(elements.get(name, {}), COLOUR)
        if colours is not None and len(colours):
            return matt(_bytes(colours))
    return Material()


def _bytes(colours: NDArray[Any]) -> Floats:
    """Colours as 0 ... 255: of shares, or of whole numbers of 8 or 16 bits."""
    if colours.dtype.kind == "f":
        return as_bytes(colours.astype(np.float64))
    return colours / 257 if colours.dtype.itemsize == 2 else colours.astype(np.float64)


def _numbers(columns: Columns, names: Sequence[str]) -> NDArray[Any] | None:
    """Columns (n, len(names)), if all of them are there."""
    if any(name not in columns or columns[name].is_list for name in names):
        return None
    return np.stack([columns[name].values for name in names], axis=1)
