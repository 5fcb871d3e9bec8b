"""OFF, the Object File Format of Geomview: polygons of one mesh, a line for each.

Normals, colours and texture coordinates are not read. Source: Geomview manual, "OFF Files".
"""

from __future__ import annotations

import re
from array import array
from pathlib import Path

import numpy as np

from simmpp.scene.formats.polygons import Polygons, triangulated
from simmpp.scene.formats.text import Source, decoded, floats, integers, shown
from simmpp.scene.node import Node
from simmpp.scene.scene import Material

HEADER = re.compile(r"(?:\s|#[^\n]*\n)*((?:ST)?C?N?(4?n?)OFF)?[ \t]*(BINARY\b)?")
"""The keyword is optional; a 4 or n says that points have other than three dimensions."""


def nodes(data: bytes, file: Path) -> list[Node]:
    """The mesh of an OFF file."""
    source = Source(file, "off")
    polygons = _polygons(_Rows(decoded(data), source), source)
    faces, _ = triangulated(polygons, source)
    return [Node(file.name, polygons.vertices, faces, Material())]


class _Rows:
    """The lines after the keyword that have words, comments aside."""

    def __init__(self, text: str, source: Source) -> None:
        header = HEADER.match(text)
        assert header is not None, "it matches nothing, too"
        keyword, dimensions, binary = header.groups()
        if binary:
            raise source.error("binary OFF is not read, make it text")
        if dimensions:
            raise source.error(f"{keyword} has points of other than three dimensions")
        self.words: list[str] = []
        self.lines, self.starts = array("q"), array("q")
        first = text.count("\n", 0, header.end()) + 1
        for line, content in enumerate(text[header.end() :].split("\n"), start=first):
            words = (content.partition("#")[0] if "#" in content else content).split()
            if words:
                self.starts.append(len(self.words))
                self.lines.append(line)
                self.words += words
        self.starts.append(len(self.words))
        if not self.lines or not (keyword or self.words[0].isdigit()):
            got = shown(self.words[0]) if self.lines else "nothing"
            raise source.error(f"expected OFF and the numbers of vertices and faces, got {got}")


def _polygons(rows: _Rows, source: Source) -> Polygons:
    words, lines, starts = rows.words, rows.lines, np.array(rows.starts)
    counts = integers(words[: starts[1]], source, lambda _: lines[0])
    if len(counts) < 2 or counts.min() < 0:
        raise source.error("expected the numbers of vertices and faces", lines[0])
    n_vertices, n_faces = counts[:2].tolist()
    first_face = 1 + n_vertices
    _refuse_other_counts(n_vertices, n_faces, rows, source)
    lengths = np.diff(starts)
    short = np.flatnonzero(lengths[1:first_face] < 3)
    if len(short):
        raise source.error("a vertex needs x, y and z", lines[1 + short[0]])
    at = starts[1:first_face].tolist()
    numbers = [word for start in at for word in words[start : start + 3]]
    vertices = floats(numbers, source, lambda i: lines[1 + i // 3]).reshape(-1, 3)
    at = starts[first_face:-1].tolist()
    sizes = integers([words[i] for i in at], source, lambda i: lines[first_face + i])
    wrong = np.flatnonzero((sizes < 0) | (sizes >= lengths[first_face:]))
    if len(wrong):
        problem = f"a face of {sizes[wrong[0]]} vertices has {lengths[first_face + wrong[0]] - 1}"
        raise source.error(problem, lines[first_face + wrong[0]])
    ends = (starts[first_face:-1] + sizes + 1).tolist()
    numbers = [word for i, end in zip(at, ends, strict=True) for word in words[i + 1 : end]]
    face = np.repeat(np.arange(n_faces), sizes)
    corners = integers(numbers, source, lambda i: lines[first_face + face[i]])
    return Polygons(
        vertices, sizes, corners, lambda i: lines[1 + i], lambda i: lines[first_face + i]
    )


def _refuse_other_counts(n_vertices: int, n_faces: int, rows: _Rows, source: Source) -> None:
    present, expected = len(rows.lines) - 1, n_vertices + n_faces
    if present < n_vertices:
        raise source.error(f"the header says {n_vertices} vertices, {present} are there")
    if present < expected:
        there = present - n_vertices
        raise source.error(f"the header says {n_faces} faces, {there} are there")
    if present > expected:
        problem = f"the header says {n_vertices} vertices and {n_faces} faces, here is more"
        raise source.error(problem, rows.lines[expected + 1])
