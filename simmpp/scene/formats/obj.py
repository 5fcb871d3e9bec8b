"""Wavefront OBJ: polygons, objects and the their materials.

Each pair of an object (``o``) and a material is a node; groups (``g``) part it if asked
for. Source:
Wavefront Technologies, "Object Files (.obj)", Advanced Visualizer manual, appendix B.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from simmpp.common.units import shown as quoted
from simmpp.scene.cut import Indices
from simmpp.scene.formats.colours import as_bytes, matt
from simmpp.scene.formats.mtl import Surface, materials
from simmpp.scene.formats.polygons import Polygons, triangulated
from simmpp.scene.formats.text import Source, decoded, floats, integers, named, shown
from simmpp.scene.node import Content, Node
from simmpp.scene.scene import Floats, Material

SKIPPED = {
    *("vt", "vn", "vp", "l", "p", "s", "mg", "bevel", "c_interp", "d_interp", "lod", "usemap"),
    *("maplib", "shadow_obj", "trace_obj", "ctech", "stech", "cstype", "deg", "bmat", "step"),
}
"""Shading, lines, points, and settings of curves and surfaces: no polygon changes by them."""
CURVED = [
    *("curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con"),
    *("bzp", "bsp", "cdc", "cdp", "res"),  # of the format's second version
]
REFUSED = {
    **dict.fromkeys(CURVED, "free-form curves and surfaces are not read, make them polygons"),
    **dict.fromkeys(["call", "csh"], "other files and commands are not read, put all in one file"),
}


Names = tuple[str, str, str]
"""Of an object, a group and a material."""


def content(data: bytes, file: Path, *, by_group: bool = False) -> Content:
    """The meshes of an OBJ file, by their names, each group apart with ``by_group``."""
    source = Source(file, "obj")
    statements = _Statements(source, by_group)
    statements.read(decoded(data))
    polygons = statements.polygons()
    faces, polygon = triangulated(polygons, source)
    group = statements.groups()[polygon]
    order = np.argsort(group, kind="stable")
    limits = np.searchsorted(group[order], np.arange(1, len(statements.names)))
    parts = dict(zip(statements.names, np.split(faces[order], limits), strict=True))
    used = {names: part for names, part in parts.items() if len(part)}
    return _content(used, statements, polygons)


class _Statements:
    """What has been read so far: words, of which numbers are made all at once."""

    def __init__(self, source: Source, by_group: bool) -> None:
        self.source, self.by_group = source, by_group
        self.coordinates: list[str] = []
        self.colours: list[str] = []
        self.corners: list[str] = []
        self.sizes = array("q")
        self.vertex_lines, self.face_lines, self.name_lines = array("q"), array("q"), array("q")
        self.object = self.group = self.material = ""
        self.names = {("", "", ""): 0}
        """Names together -> their number."""
        self.name_numbers = array("q", [0])
        """The names before each of ``name_lines``, and after the last."""
        self.libraries: list[str] = []

    def read(self, text: str) -> None:
        coordinates, vertex_lines = self.coordinates, self.vertex_lines
        corners, sizes, face_lines = self.corners, self.sizes, self.face_lines
        for line, content in _logical_lines(text):
            words = (content.partition("#")[0] if "#" in content else content).split()
            if not words:
                continue
            keyword = words[0]
            if keyword == "v":
                vertex_lines.append(line)
                coordinates += words[1:4]
                if len(words) != 4:
                    self._unusual(words, line)
            elif keyword in ("f", "fo"):
                face_lines.append(line)
                corners += words[1:]
                sizes.append(len(words) - 1)
            elif keyword not in SKIPPED:
                self._other(keyword, named(content.strip()[len(keyword) :]), line)

    def _unusual(self, vertex: list[str], line: int) -> None:
        """A vertex with a weight or a colour, or no vertex."""
        if len(vertex) < 4:
            raise self.source.error(f"a vertex needs x, y and z, got {len(vertex) - 1}", line)
        if len(vertex) >= 7:
            self.colours += vertex[4:7]

    def _other(self, keyword: str, name: str, line: int) -> None:
        match keyword:
            case "o":
                self.object = name
            case "g" if not self.by_group:
                return
            case "g":
                self.group = name
            case "usemtl":
                self.material = name
            case "mtllib":
                self.libraries.append(name)
            case _:
                problem = REFUSED.get(keyword, "no statement of OBJ")
                raise self.source.error(f"{shown(keyword)}: {problem}", line)
        self.name_lines.append(line)
        names = self.object, self.group, self.material
        number = self.names.setdefault(names, len(self.names))
        self.name_numbers.append(number)

    def groups(self) -> Indices:
        """Of each face the number of its names."""
        return np.array(self.name_numbers)[np.searchsorted(self.name_lines, self.face_lines)]

    def polygons(self) -> Polygons:
        """The faces, with vertices counted from 0; SceneError for one that is not there."""
        vertex_lines, face_lines = self.vertex_lines, self.face_lines
        vertices = floats(self.coordinates, self.source, lambda i: vertex_lines[i // 3])
        sizes, n = np.array(self.sizes), len(vertex_lines)
        few = np.flatnonzero(sizes < 3)
        if len(few):
            raise self.source.error("a face needs three vertices", face_lines[few[0]])
        face = np.repeat(np.arange(len(sizes)), sizes)
        words = [word.partition("/")[0] for word in self.corners]
        numbers = integers(words, self.source, lambda i: face_lines[face[i]])
        known = np.searchsorted(vertex_lines, face_lines)[face]
        corners = np.where(numbers > 0, numbers - 1, known + numbers)
        wrong = np.flatnonzero((numbers == 0) | (corners < 0) | (corners >= n))
        if len(wrong):
            i = wrong[0]
            expected = f"expected 1 to {n}, or -1 to -{known[i]} from the last one back"
            problem = f"a face names vertex {numbers[i]}, {expected}"
            raise self.source.error(problem, face_lines[face[i]])
        lines = vertex_lines.__getitem__, face_lines.__getitem__
        return Polygons(vertices.reshape(-1, 3), sizes, corners, *lines)

    def painted(self) -> Floats | None:
        """Colours (n, 3) of 0 ... 255, if every vertex has one."""
        if not self.colours or len(self.colours) != len(self.coordinates):
            return None
        words = floats(self.colours, self.source, lambda i: self.vertex_lines[i // 3])
        return as_bytes(words.reshape(-1, 3))


def _content(parts: dict[Names, Indices], statements: _Statements, polygons: Polygons) -> Content:
    """The named parts with what the file says of their surfaces."""
    file = statements.source.file
    surfaces, notes = _surfaces(statements, {material for *_, material in parts})
    several = len(surfaces) > 1 or len({material for *_, material in parts}) > 1
    painted = statements.painted()
    meshes = []
    for (obj, group, material), faces in parts.items():
        plain = Material() if painted is None else matt(painted[np.unique(faces)])
        surface = surfaces[material].material(plain.colour) if material in surfaces else plain
        name = "_".join(filter(None, (obj, group, material if several else ""))) or file.name
        meshes.append(Node(name, polygons.vertices, faces, surface))
    return Content(sorted(meshes, key=lambda node: node.name), notes=notes)


def _surfaces(
    statements: _Statements, used: set[str]
) -> tuple[dict[str, Surface], tuple[str, ...]]:
    """The materials of all libraries, and what of them is not as the file says."""
    surfaces: dict[str, Surface] = {}
    notes: list[str] = []
    for names in dict.fromkeys(statements.libraries):  # exporters repeat it for each object
        library = materials(names, statements.source.file.parent)
        surfaces = library.surfaces | surfaces
        notes += library.notes
    unknown = sorted(used - {"", *surfaces})
    if unknown:
        rest = f" and {len(unknown) - 1} more" if len(unknown) > 1 else ""
        notes.append(f"material {quoted(unknown[0])}{rest} is in no mtllib that was read: grey")
    return surfaces, tuple(notes)


def _logical_lines(text: str) -> Iterable[tuple[int, str]]:
    """Lines with their numbers, those that end in a backslash joined with the next."""
    lines = text.split("\n")
    return _joined(lines) if "\\\n" in text else enumerate(lines, start=1)


def _joined(lines: Sequence[str]) -> Iterator[tuple[int, str]]:
    first, begun = 0, ""
    for number, line in enumerate([*lines, ""], start=1):
        first = first or number
        if line.endswith("\\") and not line.lstrip().startswith("#"):
            begun += line[:-1] + " "
        else:
            yield first, begun + line
            first, begun = 0, ""
