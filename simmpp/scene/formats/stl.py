"""STL: triangles, in text or in binary; each solid of a text is a node.

Normals and the two bytes of attributes are not read. Source: 3D Systems, "StereoLithography
Interface Specification", 1989.
"""

from __future__ import annotations

import codecs
import re
from array import array
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.scene.formats.polygons import Polygons, triangulated
from simmpp.scene.formats.text import Line, Source, decoded, floats, named, shown
from simmpp.scene.node import Node
from simmpp.scene.scene import Floats, Material

HEADER_BYTES, COUNT_BYTES = 80, 4
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
# Possessive quantifiers: what is no STL is found to be none in one pass.
VERTEX = r"\s++vertex\s++(\S++)\s++(\S++)\s++(\S++)"
FACET = re.compile(
    r"\s*+facet(?:\s++(?!outer)\S++){0,4}+\s++outer\s++loop"
    rf"{3 * VERTEX}\s++endloop\s++endfacet\b",
    re.IGNORECASE,
)
SOLID = re.compile(r"\s*+solid\b([^\n]*+)", re.IGNORECASE)
ENDSOLID = re.compile(r"\s*+endsolid\b[^\n]*+", re.IGNORECASE)
WORD = re.compile(r"\s*+(\S*+)")


def nodes(data: bytes, file: Path) -> list[Node]:
    """The meshes of an STL file, by their names."""
    source = Source(file, "stl")
    if _is_text(data):
        return sorted(_Text(decoded(data), source).nodes(), key=lambda node: node.name)
    return [_node(file.name, _binary(data, source), lambda _: None, source)]


def _is_text(data: bytes) -> bool:
    """Whether it begins as a text does and has not the length that a binary header says.

    Many programs begin the header of a binary file with the word solid, too.
    """
    said = int.from_bytes(data[HEADER_BYTES:][:COUNT_BYTES], "little")
    if len(data) == HEADER_BYTES + COUNT_BYTES + TRIANGLE.itemsize * said:
        return False
    begin = data[:512].removeprefix(codecs.BOM_UTF8).lstrip().lower()
    return begin.startswith(b"solid") and b"\0" not in begin


def _binary(data: bytes, source: Source) -> Floats:
    """Corners (3 n, 3) float64; a count of 0 says nothing: some programs never fill it in."""
    header = HEADER_BYTES + COUNT_BYTES
    if len(data) < header:
        raise source.error(f"expected solid, or a binary header of {header} bytes")
    said = int.from_bytes(data[HEADER_BYTES:header], "little")
    there = (len(data) - header) // TRIANGLE.itemsize
    if said not in (0, there):
        raise source.error(f"the header says {said} triangles, the file holds {there}")
    triangles = np.frombuffer(data, TRIANGLE, there, header)
    return triangles["corners"].reshape(-1, 3).astype(np.float64)


class _Text:
    """A cursor over the text of solids."""

    def __init__(self, text: str, source: Source) -> None:
        self.text, self.source, self.at = text, source, 0

    def nodes(self) -> Iterator[Node]:
        """A node for each solid, in the order of the file."""
        while word := self._word():
            opening = self._take(SOLID)
            if not opening:
                raise self._error(f"expected solid, got {shown(word)}")
            name = named(opening.group(1)) or self.source.file.name
            words, starts = self._facets()
            if not self._take(ENDSOLID):
                raise self._error(self._problem(len(starts)))
            yield self._solid(name, words, starts)

    def _facets(self) -> tuple[list[str], array[int]]:
        """Nine words for each facet that comes next, and where it stands."""
        words: list[str] = []
        starts = array("q")
        while facet := self._take(FACET):
            words += facet.groups()
            starts.append(facet.start())
        return words, starts

    def _solid(self, name: str, words: list[str], starts: array[int]) -> Node:
        def line(word: int) -> int:
            facet = FACET.match(self.text, starts[word // 9])
            return self._line(facet.start(1 + word % 9) if facet else 0)

        corners = floats(words, self.source, line).reshape(-1, 3)
        return _node(name, corners, line, self.source)

    def _take(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        match = pattern.match(self.text, self.at)
        if match:
            self.at = match.end()
        return match

    def _word(self) -> str:
        """The next word; empty at the end."""
        word = WORD.match(self.text, self.at)
        return word.group(1) if word else ""

    def _problem(self, n_facets: int) -> str:
        """Why a solid does not go on after its first facets."""
        word = self._word()
        if not word:
            return f"the file ends after {n_facets} facets of a solid, without an endsolid"
        if word.lower() == "facet":
            return "this facet is cut off, or has not three vertices"
        return f"expected facet or endsolid, got {shown(word)}"

    def _error(self, problem: str) -> SceneError:
        word = WORD.match(self.text, self.at)
        return self.source.error(problem, self._line(word.start(1) if word else self.at))

    def _line(self, at: int) -> int:
        return self.text.count("\n", 0, at) + 1


def _node(name: str, corners: Floats, line: Line, source: Source) -> Node:
    """Triangles whose corners (3 n, 3) come one after the other; ``line`` is of each number."""
    n = len(corners)
    sizes = np.full(n // 3, 3, dtype=np.int64)
    lines = (lambda i: line(3 * i)), (lambda i: line(9 * i))
    faces, _ = triangulated(Polygons(corners, sizes, np.arange(n), *lines), source)
    return Node(name, corners, faces, Material())
