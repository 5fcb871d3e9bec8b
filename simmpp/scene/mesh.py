"""Meshes of files, cut into objects.

Materials come from the file (of glTF, and of OBJ's MTL), or else a colour: the mean of those of
vertices or faces. Textures are not read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from os import PathLike, fspath
from pathlib import Path

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.common.garbage import uncollected
from simmpp.common.units import counted
from simmpp.scene.boxes import scene_box
from simmpp.scene.cut import OF_OBJ, Cut, compacted, cut_named, welded
from simmpp.scene.formats import obj, off, ply, stl
from simmpp.scene.framing import far_off, framing
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.node import Content, Node, are_usable, placed, seen_through, transformed, turned
from simmpp.scene.packed import kind_of, read_whole
from simmpp.scene.parts import PartSettings
from simmpp.scene.scene import SKY_BLUE, Floats, Light, Material, MeshPart, Origin, Scene
from simmpp.scene.view import AXES, EVERYTHING, FRAMED, of_file

Reader = Callable[[bytes, Path], Content]


def _gltf(data: bytes, file: Path) -> Content:
    # Slow to import; other formats don't need it.
    from simmpp.scene.gltf.read import content

    return content(data, file)


def _plain(nodes: Callable[[bytes, Path], Sequence[Node]]) -> Reader:
    """Of a format that knows neither cameras nor lights."""
    return lambda data, file: Content(nodes(data, file))


READERS: dict[str, Reader] = {
    "glb": _gltf,
    "gltf": _gltf,
    "obj": obj.content,
    "off": _plain(off.nodes),
    "ply": _plain(ply.nodes),
    "stl": _plain(stl.nodes),
}
"""By the ending of the file's name: from its bytes and its name to the meshes in it."""
Z_UP_FORMATS = ("stl",)
"""Formats of construction, where z points up; in the others (glTF by its standard) y does."""


def load_mesh(
    path: str | PathLike[str], *, objects: object = "components", up: str | None = None
) -> Scene:
    """The scene of a mesh file, cut into objects; see :func:`load_parts`."""
    return load_parts([PartSettings(mesh=fspath(path))], objects=objects, up=up)


@uncollected()
@np.errstate(over="ignore", invalid="ignore")  # what is not finite is refused here, in words
def load_parts(
    parts: Sequence[PartSettings], *, objects: object = "components", up: str | None = None
) -> Scene:
    """The scene of mesh files in their places, cut into objects.

    ``objects`` is ``nodes``, ``components``, ``groups`` (of OBJ) or ``{clusters: k}`` (at most k
    triangles each); a cut never joins two nodes. Nodes are ordered by name, in glTF as the file
    has them, components by their first triangle, clusters by bisection. Where no file has a camera,
    one sees everything, with ``up`` (``y`` or ``z``; by the format without) upwards. Raises
    SceneError for a file that can't be read, or that holds no triangle, or a vertex that is not
    finite.
    """
    label, cut = cut_named(objects)
    files = [Path(part.mesh) for part in parts]
    materials: dict[Material, int] = {}
    pieces: list[MeshPart] = []
    contents = []
    for number, (file, part) in enumerate(zip(files, parts, strict=True)):
        content = _put(_read(file, label == OF_OBJ), file, part.matrix)
        prefix = f"{number}.{file.stem}/" if len(parts) > 1 else ""
        for node in content.nodes:
            material = materials.setdefault(node.material, len(materials))
            pieces.extend(_pieces(node._replace(name=prefix + node.name), cut, material))
        contents.append(content._replace(nodes=()))
    where = str(files[0]) if len(files) == 1 else "the parts"
    if not pieces:
        raise SceneError("no triangles", where=where)
    bounds = scene_box(pieces)
    if not np.any(bounds[1] > bounds[0]):
        raise SceneError("all vertices are the same point", where=where)
    name = f"{files[0].name}{f'+{len(files) - 1}' if len(files) > 1 else ''}:{label}"
    axis = up or ("z" if all(kind_of(file) in Z_UP_FORMATS for file in files) else "y")
    return _seen(name, tuple(pieces), tuple(materials), contents, bounds, axis)


def _seen(
    name: str,
    pieces: tuple[MeshPart, ...],
    materials: tuple[Material, ...],
    contents: Sequence[Content],
    bounds: Floats,
    axis: str,
) -> Scene:
    """The scene with the camera and the lights of its files, or else with some of our own."""
    up = AXES[axis]
    camera, lights = framing(bounds, up=up)
    cameras = tuple(found for content in contents for found in content.cameras)
    lamps = [light for content in contents for light in content.lights]
    lamps += [far_off(sun, bounds) for content in contents for sun in content.suns]
    said, lit = f"{FRAMED}, {axis} up", f"{counted(len(lights), 'light')} beside it"
    cameras = (*cameras, (EVERYTHING, camera))
    if len(cameras) > 1:
        said, camera = of_file(cameras[0][0]), cameras[0][1]
    if lamps:
        lit, lights = f"{counted(len(lamps), 'light')} of the file", tuple(lamps)
    notes = tuple(dict.fromkeys(note for content in contents for note in content.notes))
    origin = Origin(said, lit, cameras, up, notes)
    return Scene(name, pieces, materials, lights, camera, SKY_BLUE, origin)


def _pieces(node: Node, cut: Cut, material: int) -> Iterator[MeshPart]:
    vertices, faces = welded(node.vertices, node.faces)
    pieces = compacted(vertices, faces, cut(vertices, faces))
    for i, piece in enumerate(pieces):
        name = node.name if len(pieces) == 1 else f"{node.name}/{i}"
        yield MeshPart(*piece, material, name)


def _read(file: Path, by_group: bool) -> Content:
    """The content of a file, checked as far as its triangles go."""
    data = read_whole(file)
    kind = kind_of(file)
    read = READERS.get(kind)
    if read is None:
        known = f"neither NFF (.nff) nor a mesh that is read ({', '.join(READERS)}, or .gz of one)"
        raise SceneError(f"{known}: convert it to GLB, OBJ or PLY", where=str(file))
    if by_group:
        if kind != "obj":
            problem = f"objects: groups are of OBJ, this is {kind}: expected nodes or another cut"
            raise SceneError(problem, where=str(file))
        read = partial(obj.content, by_group=True)
    content = read(data, file)
    return content._replace(nodes=[node for node in content.nodes if len(node.faces)])


def _put(content: Content, file: Path, matrix: Floats) -> Content:
    """The content in its place; SceneError for a vertex that is none there."""
    if (matrix != np.eye(4)).any():
        content = _moved(content, matrix)
    for node in content.nodes:
        if not (are_usable(node.vertices) or are_usable(node.vertices[node.faces])):
            problem = f"a vertex of {node.name!r} is not a finite number of at most {LARGEST:g}"
            raise SceneError(problem, where=str(file))
    return content


def _moved(content: Content, matrix: Floats) -> Content:
    return content._replace(
        nodes=[
            Node(node.name, *placed(node.vertices, node.faces, matrix), node.material)
            for node in content.nodes
        ],
        cameras=tuple((name, seen_through(c, matrix)) for name, c in content.cameras),
        lights=tuple(_light_at(light, matrix) for light in content.lights),
        suns=tuple(replace(sun, position=turned(sun.position, matrix)) for sun in content.suns),
    )


def _light_at(light: Light, matrix: Floats) -> Light:
    (position,) = transformed(np.array([light.position]), matrix).tolist()
    return replace(light, position=tuple(position))
