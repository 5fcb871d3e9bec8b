"""Meshes of files, cut into objects.

Colours come from the file: the base colour of a material, or the mean of vertex or face colours;
textures are not read. A glTF material reflects if it is clearly a mirror; everything is opaque.
Camera and lights of the file are not read either.
"""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.common.garbage import uncollected
from simmpp.scene.boxes import scene_box
from simmpp.scene.cut import Cut, compacted, cut_named
from simmpp.scene.formats import obj, off, ply, stl
from simmpp.scene.framing import framing
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.node import Node, are_usable
from simmpp.scene.packed import kind_of, read_whole
from simmpp.scene.scene import SKY_BLUE, Material, MeshPart, Scene, Vector
from simmpp.scene.weld import welded


def _gltf(data: bytes, file: Path) -> list[Node]:
    # Slow to import; other formats don't need it.
    from simmpp.scene.gltf.read import nodes

    return nodes(data, file)


READERS = {
    "glb": _gltf,
    "gltf": _gltf,
    "obj": obj.nodes,
    "off": off.nodes,
    "ply": ply.nodes,
    "stl": stl.nodes,
}
"""By the ending of the file's name: from its bytes and its name to the meshes in it."""
Y_UP: Vector = (0.0, 1.0, 0.0)
Z_UP: Vector = (0.0, 0.0, 1.0)
Z_UP_FORMATS = ("stl",)
"""Formats of construction, where z points up; in the others (glTF by its standard) y does."""


@np.errstate(over="ignore", invalid="ignore")  # what is not finite is refused here, in words
def load_mesh(path: str | PathLike[str], *, objects: object = "components") -> Scene:
    """The scene of a mesh file, cut into objects.

    ``objects`` is ``nodes``, ``components`` or ``{clusters: k}`` (at most k triangles each); a cut
    never joins two nodes. Nodes are ordered by name, in glTF as the file has them, components by
    their first triangle, clusters by bisection. The camera shows everything. Raises SceneError for
    a file that can't be read, or that holds no triangle, or a vertex that is not finite.
    """
    file = Path(fspath(path))
    label, cut = cut_named(objects)
    materials: dict[Material, int] = {}
    parts: list[MeshPart] = []
    with uncollected():
        for node in _nodes(file):
            material = materials.setdefault(node.material, len(materials))
            parts.extend(_parts(node, cut, material))
    if not parts:
        raise SceneError("no triangles", where=str(file))
    bounds = scene_box(parts)
    if not np.any(bounds[1] > bounds[0]):
        raise SceneError("all vertices are the same point", where=str(file))
    up = Z_UP if kind_of(file) in Z_UP_FORMATS else Y_UP
    camera, lights = framing(bounds, up=up)
    name = f"{file.name}:{label}"
    return Scene(name, tuple(parts), tuple(materials), lights, camera, SKY_BLUE)


def _parts(node: Node, cut: Cut, material: int) -> Iterator[MeshPart]:
    vertices, faces = welded(node.vertices, node.faces)
    pieces = compacted(vertices, faces, cut(vertices, faces))
    for i, piece in enumerate(pieces):
        name = node.name if len(pieces) == 1 else f"{node.name}/{i}"
        yield MeshPart(*piece, material, name)


def _nodes(file: Path) -> Iterator[Node]:
    """The meshes of a file that have triangles."""
    read = READERS.get(kind_of(file))
    if read is None:
        known = f"neither NFF (.nff) nor a mesh that is read ({', '.join(READERS)}, or .gz of one)"
        raise SceneError(f"{known}: convert it to GLB, OBJ or PLY", where=str(file))
    for node in read(read_whole(file), file):
        if not len(node.faces):
            continue
        if not (are_usable(node.vertices) or are_usable(node.vertices[node.faces])):
            problem = f"a vertex of {node.name!r} is not a finite number of at most {LARGEST:g}"
            raise SceneError(problem, where=str(file))
        yield node
