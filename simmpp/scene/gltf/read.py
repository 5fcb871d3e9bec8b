"""What a glTF file shows: its meshes in their places, in the file's order, and its view."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.scene.cut import Indices
from simmpp.scene.formats.colours import of_textures
from simmpp.scene.gltf.accessors import Arrays
from simmpp.scene.gltf.container import Buffers, split
from simmpp.scene.gltf.document import compressed, item, parsed
from simmpp.scene.gltf.places import copies, worlds
from simmpp.scene.gltf.schema import Document, Primitive
from simmpp.scene.gltf.surfaces import material, textured
from simmpp.scene.gltf.views import cameras_in, lights_in
from simmpp.scene.node import Content, Node, placed
from simmpp.scene.scene import Floats, Material

TRIANGLES, STRIP = 4, 5
MOST_OBJECTS, MOST_TRIANGLES = 1_000_000, 100_000_000
"""Of a scene: a small file can name one mesh often."""
Weights = tuple[float, ...]


class _Piece(NamedTuple):
    """The triangles of a primitive, where its mesh has them."""

    suffix: str
    vertices: Floats
    faces: Indices
    material: Material


def content(data: bytes, file: Path) -> Content:
    """What a glTF or GLB file shows: nodes in order of their index, then primitives.

    A primitive is named after its node (its index if it has no name), ``.1`` after it if the mesh
    has several, ``[2]`` if it is an instance. Points and lines have no surface and are left out.
    ``file`` is where other buffers are beside, and what the SceneError names that is raised for
    what is damaged or not read.
    """
    try:
        text, chunk = split(data, binary=file.name.lower().removesuffix(".gz").endswith(".glb"))
        document = parsed(text)
        buffers = Buffers(document, chunk, file.parent)
        places = worlds(document)
        nodes = list(_nodes(document, places, Arrays(document, buffers)))
        cameras, why_not = cameras_in(document, places)
        lights, suns, of_lights = lights_in(document, places)
        notes = [*why_not, *of_lights]
        if names := textured(document):
            notes.append(of_textures(names))
        return Content(nodes, cameras, lights, suns, tuple(notes))
    except SceneError as error:
        raise SceneError(error.problem, where=str(file)) from None


def _nodes(document: Document, places: dict[int, Floats], arrays: Arrays) -> Iterator[Node]:
    pieces = cache(partial(_pieces, document, arrays))
    objects = triangles = 0
    for at, world in places.items():
        node = document.nodes[at]
        if node.mesh is None:
            continue
        if node.skin is not None:
            problem = "its mesh is bent by a skin, which is not read: save it in its pose"
            raise SceneError(f"nodes[{at}]: {problem}")
        mesh = item(document.meshes, node.mesh, "meshes")
        own = pieces(node.mesh, tuple(mesh.weights if node.weights is None else node.weights))
        matrices = copies(world, node, arrays)
        objects += len(matrices) * len(own)
        triangles += len(matrices) * sum(len(piece.faces) for piece in own)
        if objects > MOST_OBJECTS or triangles > MOST_TRIANGLES:
            most = f"{MOST_OBJECTS} primitives and {MOST_TRIANGLES} triangles"
            raise SceneError(f"its nodes place more than {most}")
        for copy, matrix in enumerate(matrices):
            number = "" if node.extensions.instancing is None else f"[{copy}]"
            for piece in own:
                vertices, faces = placed(piece.vertices, piece.faces, matrix)
                name = f"{node.name or at}{number}{piece.suffix}"
                yield Node(name, vertices, faces, piece.material)


def _pieces(document: Document, arrays: Arrays, mesh: int, weights: Weights) -> list[_Piece]:
    """The primitives of a mesh that have triangles."""
    primitives = document.meshes[mesh].primitives
    pieces = []
    for i, primitive in enumerate(primitives):
        if primitive.mode < TRIANGLES:
            continue
        try:
            piece = _piece(document, arrays, primitive, weights)
        except SceneError as error:
            raise SceneError(f"meshes[{mesh}].primitives[{i}]: {error.problem}") from None
        pieces.append(piece._replace(suffix=f".{i}" if len(primitives) > 1 else ""))
    return [piece for piece in pieces if len(piece.faces)]


def _piece(document: Document, arrays: Arrays, primitive: Primitive, weights: Weights) -> _Piece:
    if "POSITION" not in primitive.attributes:
        raise SceneError("no POSITION: expected where its vertices are")
    if primitive.extensions.draco is not None and not arrays.has_data(
        primitive.attributes["POSITION"]
    ):
        raise compressed("Draco")
    if primitive.targets and weights and len(weights) != len(primitive.targets):
        raise SceneError(f"{len(weights)} weights for {len(primitive.targets)} morph targets")
    vertices = _attribute(arrays, primitive, "POSITION", weights)
    colours = None
    if "COLOR_0" in primitive.attributes:
        colours = _attribute(arrays, primitive, "COLOR_0", weights)
        if len(colours) != len(vertices):
            raise SceneError(f"{len(colours)} colours for {len(vertices)} vertices")
    faces = _faces(arrays, primitive, len(vertices))
    return _Piece("", vertices, faces, material(document, primitive.material, colours))


def _attribute(arrays: Arrays, primitive: Primitive, name: str, weights: Weights) -> Floats:
    """What the file says of each vertex, morphed as it is at rest."""
    is_colour = name == "COLOR_0"
    types = ("VEC3", "VEC4") if is_colour else ("VEC3",)
    values = arrays.numbers(primitive.attributes[name], *types, normalized=is_colour)
    for weight, target in zip(weights, primitive.targets, strict=False):
        if name in target and weight:
            change = arrays.numbers(target[name], *types, normalized=is_colour)
            if change.shape != values.shape:
                raise SceneError(f"a morph target of {len(change)} for {len(values)} vertices")
            values = values + weight * change
    return values


def _faces(arrays: Arrays, primitive: Primitive, vertices: int) -> Indices:
    """(m, 3) into ``vertices`` vertices."""
    corners: Indices
    if primitive.indices is None:
        corners = np.arange(vertices)
    else:
        corners = arrays.indices(primitive.indices)
        if corners.max() >= vertices:
            problem = f"a triangle names vertex {corners.max()}"
            raise SceneError(f"{problem}, but there are {vertices} vertices")
    corners = corners.astype(np.int32)
    if len(corners) < 3 or (primitive.mode == TRIANGLES and len(corners) % 3):
        raise SceneError(f"{len(corners)} corners are not whole triangles")
    if primitive.mode == TRIANGLES:
        return corners.reshape(-1, 3)
    if primitive.mode == STRIP:
        return _strip(corners)
    first = np.full(len(corners) - 2, corners[0])
    return np.stack([corners[1:-1], corners[2:], first], axis=1)


def _strip(corners: Indices) -> Indices:
    """The triangles of a strip; one with a vertex twice only leads to where another part begins."""
    faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
    faces[1::2, 1:] = faces[1::2, :0:-1]
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (c != a)]
