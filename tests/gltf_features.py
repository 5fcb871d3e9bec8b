"""A file for each feature of glTF, with the triangles that the format says it has."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from gltf_files import HALVES, SQUARE, File, described, one_square

from simmpp.scene.scene import Floats

Corners = list[tuple[Any, Any, Any]]
UNIT: Corners = [tuple(SQUARE[i] for i in face) for face in ((0, 1, 2), (0, 2, 3))]  # type: ignore[misc]
TURNED = [0, 0, math.sqrt(0.5), math.sqrt(0.5)]
"""A quarter around z: (x, y) to (-y, x)."""


def moved(corners: Any, scale: float = 1.0, offset: Any = (0, 0, 0)) -> Floats:
    return np.array(corners, dtype=float) * scale + offset


def positions(kind: str, rows: Any, **more: Any) -> File:
    """Two triangles from positions as they are stored."""
    file = File()
    numbers = np.array(rows, dtype=f"<{kind}")
    padded = np.zeros((len(numbers), 4 if numbers.itemsize < 4 else 3), numbers.dtype)
    padded[:, :3] = numbers  # each on a multiple of 4 bytes
    view = file.view(padded.tobytes(), byteStride=padded.strides[0])
    accessor = file.add("accessors", **described(numbers, kind, bufferView=view) | more)
    halves = file.accessor(HALVES, "u1")
    file.node(mesh=file.mesh({"attributes": {"POSITION": accessor}, "indices": halves}))
    return file


def plain() -> File:
    return one_square()


def without_indices() -> File:
    file = File()
    corners = file.accessor([SQUARE[i] for i in HALVES])
    file.node(mesh=file.mesh({"attributes": {"POSITION": corners}}))
    return file


def indices_of(kind: str) -> File:
    file = File()
    attributes = {"POSITION": file.accessor(SQUARE)}
    indices = file.accessor(HALVES, kind)
    file.node(mesh=file.mesh({"attributes": attributes, "indices": indices}))
    return file


def interleaved() -> File:
    """Normals and positions in turn, behind 8 bytes of something else; the last ends the view."""
    file = File()
    rows = np.hstack([np.full((4, 3), 9, "<f4"), np.array(SQUARE, "<f4")])
    view = file.view(b"12345678" + rows.tobytes(), byteStride=24)
    where = {"bufferView": view, "byteOffset": 8 + 12}
    accessor = file.add("accessors", **described(rows[:, 3:], "f4", **where))
    indices = file.accessor(HALVES, "u2")
    file.node(mesh=file.mesh({"attributes": {"POSITION": accessor}, "indices": indices}))
    return file


def corners_in(mode: int, *corners: int) -> File:
    file = File()
    attributes = {"POSITION": file.accessor(SQUARE)}
    indices = file.accessor(corners, "u2")
    primitive = {"attributes": attributes, "indices": indices, "mode": mode}
    file.node(mesh=file.mesh(primitive))
    return file


def sparse(**base: Any) -> File:
    """The square, its third corner moved to (3, 3, 0) by a sparse accessor."""
    file = File()
    file.node(mesh=file.mesh(file.square()))
    file.json["accessors"][0] |= {"sparse": changes(file, [2], [(3, 3, 0)])} | base
    return file


def changes(file: File, places: list[int], rows: Any) -> dict[str, Any]:
    indices = {"bufferView": file.view(np.array(places, "<u2").tobytes()), "componentType": 5123}
    values = {"bufferView": file.view(np.array(rows, "<f4").tobytes())}
    return {"count": len(places), "indices": indices, "values": values}


def sparse_without_base() -> File:
    file = sparse()
    first = file.json["accessors"][0]
    del first["bufferView"]
    first["sparse"] = changes(file, [1, 2, 3], SQUARE[1:])
    return file


def morphed(**where: Any) -> File:
    """Two targets: up by z = 1, and sideways by x = 10 where the weight is half."""
    file = File()
    targets = [
        {"POSITION": file.accessor([(0, 0, 1)] * 4)},
        {"POSITION": file.accessor([(10, 0, 0)] * 4)},
    ]
    mesh = file.mesh(file.square(targets=targets), **where.pop("mesh", {}))
    file.node(mesh=mesh, **where)
    return file


def instanced() -> File:
    """Three instances: moved; turned; moved and twice as large; all below a node at z = 5."""
    file = one_square(translation=[0, 0, 5])
    attributes = {
        "TRANSLATION": file.accessor([(1, 0, 0), (0, 0, 0), (7, 7, 7)]),
        "ROTATION": file.accessor([(0, 0, 0, 1), TURNED, (0, 0, 0, 1)]),
        "SCALE": file.accessor([(1, 1, 1), (1, 1, 1), (2, 2, 2)]),
    }
    file.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    file.require("EXT_mesh_gpu_instancing")
    return file


def tree() -> File:
    """A turned and scaled child below a moved parent, whose matrix is written column by column."""
    file = File()
    mesh = file.mesh(file.square())
    child = file.node(root=False, mesh=mesh, rotation=TURNED, scale=[2, 2, 2])
    matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1]
    file.node(matrix=matrix, children=[child])
    return file


def one_mesh_in_two_nodes() -> File:
    file = one_square()
    file.node(mesh=0, translation=[5, 0, 0])
    return file


def second_scene() -> File:
    """The file's scene is its second."""
    file = one_square()
    file.json["scenes"].append({"nodes": [file.node(root=False, mesh=0, translation=[0, 0, 9])]})
    file.json["scene"] = 1
    return file


def no_scene_named() -> File:
    file = second_scene()
    del file.json["scene"]
    return file


def no_scenes() -> File:
    file = tree()
    del file.json["scene"], file.json["scenes"]
    return file


def hidden() -> File:
    """Of two squares one is below a node that is not seen."""
    file = one_square()
    child = file.node(root=False, mesh=0, translation=[0, 0, 9])
    extension = {"KHR_node_visibility": {"visible": False}}
    file.json["extensionsUsed"] = ["KHR_node_visibility"]
    file.node(children=[child], extensions=extension)
    return file


def points_and_lines() -> File:
    file = File()
    modes = [file.square(mode=mode) for mode in (0, 1, 2, 3)]
    file.node(mesh=file.mesh(*modes[:2], file.square(), *modes[2:]))
    return file


def draco_with_plain_data() -> File:
    """Compressed, but not required: the plain numbers are there as well."""
    file = one_square()
    extension = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    file.json["meshes"][0]["primitives"][0]["extensions"] = extension
    file.json["extensionsUsed"] = ["KHR_draco_mesh_compression"]
    return file


def painted() -> File:
    file = one_square()
    primitive = file.json["meshes"][0]["primitives"][0]
    primitive["attributes"]["COLOR_0"] = file.accessor([(0, 51, 255)] * 4, "u1")
    factors = {"baseColorFactor": [1, 0, 0, 1], "metallicFactor": 1, "roughnessFactor": 0.1}
    primitive["material"] = file.add("materials", pbrMetallicRoughness=factors)
    return file


def of_textures() -> File:
    file = one_square()
    file.require("KHR_texture_transform", "KHR_materials_unlit", "KHR_lights_punctual")
    return file


def of_a_later_version() -> File:
    """What a reader of 2.0 doesn't know is not looked at: nothing says that it must be."""
    file = one_square()
    file.json |= {"asset": {"version": "2.1"}, "holograms": [{"mesh": 0}]}
    return file


ROTATED = [[(-2 * y, 2 * x, 0) for x, y, _ in face] for face in UNIT]


def seen_and_lit() -> File:
    """Glass with a texture, cameras and lights of all kinds, all below a mirrored node."""
    file = File()
    extensions = {"KHR_materials_transmission": {"transmissionFactor": 0.5}}
    extensions |= {"KHR_materials_ior": {"ior": 1.25}}
    base = {"baseColorTexture": {"index": 0}, "metallicFactor": 0}
    glass = file.add("materials", pbrMetallicRoughness=base, extensions=extensions)
    kinds = ("point", "spot", "directional")
    lights = [{"type": kind, "color": [1, 0.5, 0], "intensity": 3} for kind in kinds]
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    file.add("cameras", type="perspective", perspective={"yfov": 0.7, "znear": 1})
    file.add("cameras", type="orthographic")
    placed = [
        {"mesh": file.mesh(file.square(material=glass))},
        *({"camera": number, "translation": [0, number, 9]} for number in (0, 1)),
        *({"extensions": {"KHR_lights_punctual": {"light": number}}} for number in (0, 1, 2)),
    ]
    children = [file.node(root=False, **node) for node in placed]
    file.node(children=children, scale=[-1, 1, 1])
    return file


FEATURES: dict[str, tuple[Callable[[], File], Floats]] = {
    "plain": (plain, moved(UNIT)),
    "no indices": (without_indices, moved(UNIT)),
    "indices of 8 bits": (lambda: indices_of("u1"), moved(UNIT)),
    "indices of 16 bits": (lambda: indices_of("u2"), moved(UNIT)),
    "indices of 32 bits": (lambda: indices_of("u4"), moved(UNIT)),
    "interleaved": (interleaved, moved(UNIT)),
    "integers of 8 bits": (lambda: positions("i1", np.array(SQUARE) * -5), moved(UNIT, -5)),
    "unsigned of 8 bits": (lambda: positions("u1", np.array(SQUARE) * 200), moved(UNIT, 200)),
    "integers of 16 bits": (lambda: positions("i2", np.array(SQUARE) * -300), moved(UNIT, -300)),
    "unsigned of 16 bits": (lambda: positions("u2", np.array(SQUARE) * 60000), moved(UNIT, 60000)),
    "normalised 8 bits": (
        lambda: positions("i1", np.array(SQUARE) * 127, normalized=True),
        moved(UNIT),
    ),
    "normalised -128 is -1": (
        lambda: positions("i1", np.array(SQUARE) * -128, normalized=True),
        moved(UNIT, -1),
    ),
    "normalised unsigned 8 bits": (
        lambda: positions("u1", np.array(SQUARE) * 51, normalized=True),
        moved(UNIT, 0.2),
    ),
    "normalised 16 bits": (
        lambda: positions("i2", np.array(SQUARE) * 32767, normalized=True),
        moved(UNIT),
    ),
    "normalised unsigned 16 bits": (
        lambda: positions("u2", np.array(SQUARE) * 65535, normalized=True),
        moved(UNIT),
    ),
    "strip": (
        lambda: corners_in(5, 1, 2, 0, 3),
        moved([(SQUARE[1], SQUARE[2], SQUARE[0]), (SQUARE[2], SQUARE[3], SQUARE[0])]),
    ),
    "strip of two parts": (
        lambda: corners_in(5, 0, 1, 2, 2, 0, 0, 0, 2, 3),
        moved([(SQUARE[0], SQUARE[1], SQUARE[2]), (SQUARE[0], SQUARE[2], SQUARE[3])]),
    ),
    "fan": (
        lambda: corners_in(6, 0, 1, 2, 3),
        moved([(SQUARE[1], SQUARE[2], SQUARE[0]), (SQUARE[2], SQUARE[3], SQUARE[0])]),
    ),
    "points and lines": (points_and_lines, moved(UNIT)),
    "sparse": (
        sparse,
        moved([((0, 0, 0), (1, 0, 0), (3, 3, 0)), ((0, 0, 0), (3, 3, 0), (0, 1, 0))]),
    ),
    "sparse without a base": (sparse_without_base, moved(UNIT)),
    "morphed by the mesh": (
        lambda: morphed(mesh={"weights": [1, 0.5]}),
        moved(UNIT, offset=(5, 0, 1)),
    ),
    "morphed by the node": (
        lambda: morphed(weights=[0, 2], mesh={"weights": [1, 0.5]}),
        moved(UNIT, offset=(20, 0, 0)),
    ),
    "not morphed": (morphed, moved(UNIT)),
    "instanced": (
        instanced,
        np.concatenate(
            [
                moved(UNIT, offset=(1, 0, 5)),
                moved(ROTATED, 0.5, offset=(0, 0, 5)),
                moved(UNIT, 2, offset=(7, 7, 12)),
            ]
        ),
    ),
    "tree": (tree, moved(ROTATED, offset=(10, 20, 30))),
    "mirrored": (
        lambda: one_square(scale=[-1, 1, 1]),
        np.array(UNIT, dtype=float)[:, ::-1] * (-1, 1, 1),
    ),
    "seen and lit": (seen_and_lit, np.array(UNIT, dtype=float)[:, ::-1] * (-1, 1, 1)),
    "one mesh in two nodes": (
        one_mesh_in_two_nodes,
        np.concatenate([moved(UNIT), moved(UNIT, offset=(5, 0, 0))]),
    ),
    "the scene that is named": (second_scene, moved(UNIT, offset=(0, 0, 9))),
    "the first scene": (no_scene_named, moved(UNIT)),
    "no scenes": (no_scenes, moved(ROTATED, offset=(10, 20, 30))),
    "hidden": (hidden, moved(UNIT)),
    "draco with plain data": (draco_with_plain_data, moved(UNIT)),
    "painted": (painted, moved(UNIT)),
    "a later version": (of_a_later_version, moved(UNIT)),
    "extensions of textures": (of_textures, moved(UNIT)),
}
