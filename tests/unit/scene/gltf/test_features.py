"""A file for each feature of glTF, written here, with the triangles that the format says it has."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import quote_from_bytes

import numpy as np
import pytest
import trimesh
from gltf_files import HALVES, SQUARE, File, described, one_square

from simmpp.scene.gltf.read import nodes
from simmpp.scene.scene import Floats, Material

Corners = list[tuple[Any, Any, Any]]
UNIT: Corners = [tuple(SQUARE[i] for i in face) for face in ((0, 1, 2), (0, 2, 3))]  # type: ignore[misc]
TURNED = [0, 0, math.sqrt(0.5), math.sqrt(0.5)]
"""A quarter around z: (x, y) to (-y, x)."""


def triangles(data: bytes, file: Path = Path("a.gltf")) -> Floats:
    found = nodes(data, file)
    return np.concatenate([node.vertices[node.faces] for node in found] or [np.zeros((0, 3, 3))])


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
    """Positions and normals in turn, behind 8 bytes of something else."""
    file = File()
    rows = np.hstack([np.array(SQUARE, "<f4"), np.full((4, 3), 9, "<f4")])
    view = file.view(b"12345678" + rows.tobytes(), byteStride=24)
    where = {"bufferView": view, "byteOffset": 8}
    accessor = file.add("accessors", **described(rows[:, :3], "f4", **where))
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
    file.json["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
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


def of_textures() -> File:
    file = one_square()
    names = ["KHR_texture_transform", "KHR_materials_unlit", "KHR_lights_punctual"]
    file.json |= {
        "extensionsRequired": names,
        "images": "not looked at",
        "asset": {"version": "2.1"},
    }
    return file


ROTATED = [[(-2 * y, 2 * x, 0) for x, y, _ in face] for face in UNIT]
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
    "one mesh in two nodes": (
        one_mesh_in_two_nodes,
        np.concatenate([moved(UNIT), moved(UNIT, offset=(5, 0, 0))]),
    ),
    "the scene that is named": (second_scene, moved(UNIT, offset=(0, 0, 9))),
    "the first scene": (no_scene_named, moved(UNIT)),
    "no scenes": (no_scenes, moved(ROTATED, offset=(10, 20, 30))),
    "hidden": (hidden, moved(UNIT)),
    "draco with plain data": (draco_with_plain_data, moved(UNIT)),
    "extensions of textures": (of_textures, moved(UNIT)),
}
TRIMESH_READS = {
    *("plain", "no indices", "indices of 8 bits", "indices of 16 bits", "indices of 32 bits"),
    *("interleaved", "integers of 8 bits", "unsigned of 16 bits", "strip", "tree", "mirrored"),
    *("one mesh in two nodes", "the scene that is named", "the first scene", "not morphed"),
}
"""What an independent reader gets right too; the rest it drops or takes for something else."""


@pytest.mark.parametrize("feature", FEATURES)
def test_feature(feature: str) -> None:
    build, expected = FEATURES[feature]
    for data in (build().gltf(), build().glb()):
        np.testing.assert_allclose(triangles(data), expected, atol=1e-12)


@pytest.mark.parametrize("feature", sorted(TRIMESH_READS))
def test_another_reader_finds_the_same(tmp_path: Path, feature: str) -> None:
    path = FEATURES[feature][0]().write(tmp_path / "a.glb")
    theirs = trimesh.load_scene(path, process=False).to_geometry()
    mine = triangles(path.read_bytes())
    assert len(mine) == len(theirs.faces)
    np.testing.assert_allclose(
        (mine.reshape(-1, 3).min(0), mine.reshape(-1, 3).max(0)), theirs.bounds
    )
    sides = np.cross(mine[:, 1] - mine[:, 0], mine[:, 2] - mine[:, 0])
    assert np.linalg.norm(sides, axis=1).sum() / 2 == pytest.approx(theirs.area)


# --- where the bytes are ---


@pytest.mark.parametrize("name", ["my data.bin", "50%.bin", "sub/ä.bin", "n\udcfc.bin"])
def test_a_buffer_beside_the_file(tmp_path: Path, name: str) -> None:
    file = one_square()
    place = tmp_path / name
    place.parent.mkdir(exist_ok=True)
    place.write_bytes(bytes(file.data) + b"more")
    uri = quote_from_bytes(name.encode("utf-8", "surrogateescape"))
    np.testing.assert_array_equal(triangles(file.gltf(uri), tmp_path / "a.gltf"), moved(UNIT))


def test_a_buffer_in_plain_percent_encoding() -> None:
    file = one_square()
    uri = "data:," + "".join(f"%{byte:02x}" for byte in file.data)
    np.testing.assert_array_equal(triangles(file.gltf(uri)), moved(UNIT))


def test_a_binary_file_under_the_name_of_a_text() -> None:
    np.testing.assert_array_equal(triangles(one_square().glb(), Path("a.gltf")), moved(UNIT))


# --- names and order ---


def test_the_order_is_that_of_nodes_then_of_primitives() -> None:
    """Whatever the order of the scene's roots and children."""
    file = File()
    mesh = file.mesh(*(file.square() for _ in range(3)))
    names = ["z", "a", None, "a"]
    for at, name in enumerate(names):
        named = {"name": name} if name else {}
        file.node(root=at != 0, mesh=mesh, translation=[at, 0, 0], **named)
    file.json["nodes"][3]["children"] = [0]
    file.json["scenes"][0]["nodes"].reverse()
    found = nodes(file.gltf(), Path("a.gltf"))
    assert [node.name for node in found] == [
        f"{name or at}.{primitive}" for at, name in enumerate(names) for primitive in range(3)
    ]
    assert [node.vertices[0, 0] for node in found] == [*[3] * 3, *[1] * 3, *[2] * 3, *[3] * 3]


def test_names_of_instances() -> None:
    found = nodes(instanced().gltf(), Path("a.gltf"))
    assert [node.name for node in found] == ["0[0]", "0[1]", "0[2]"]


# --- materials ---


def painted(*, colours: Any = None, kind: str = "f4", **surface: Any) -> Material:
    file = File()
    primitive = file.square()
    if colours is not None:
        primitive["attributes"]["COLOR_0"] = file.accessor(colours, kind)
    if surface:
        primitive["material"] = file.add("materials", **surface)
    file.node(mesh=file.mesh(primitive))
    return nodes(file.gltf(), Path("a.gltf"))[0].material


def metallic(**values: Any) -> Material:
    return painted(pbrMetallicRoughness=values)


RED = {"baseColorFactor": [1, 0, 0, 1]}
MIRROR = {"kd": 0.5, "ks": 0.5}
MATERIALS = [
    (painted(), Material()),
    (painted(name="nothing said"), Material()),
    (metallic(**RED), Material((1, 0, 0))),
    (metallic(**RED, roughnessFactor=0.3), Material((1, 0, 0), **MIRROR)),
    (metallic(**RED, roughnessFactor=0.31), Material((1, 0, 0))),
    (metallic(**RED, roughnessFactor=0, metallicFactor=0.89), Material((1, 0, 0))),
    (metallic(baseColorFactor=[2, -1, 0.5, 1]), Material((1, 0, 128 / 255))),
    (painted(colours=[(1, 0, 0)] * 2 + [(0, 0, 0.2)] * 2), Material((0.5, 0, 0.1))),
    (painted(colours=[(51, 0, 255, 9)] * 4, kind="u1"), Material((0.2, 0, 1))),
    (painted(colours=[(13107, 0, 65535)] * 4, kind="u2"), Material((0.2, 0, 1))),
    (painted(colours=[(1, 0, 0)] * 4, pbrMetallicRoughness={"roughnessFactor": 1}), Material()),
]


@pytest.mark.parametrize(("found", "expected"), MATERIALS)
def test_materials(found: Material, expected: Material) -> None:
    assert (found.kd, found.ks) == (expected.kd, expected.ks)
    assert found.colour == pytest.approx(expected.colour, abs=1e-12)


@pytest.mark.parametrize(
    ("surface", "reflects"),
    [
        ({"diffuseFactor": [0.2, 0.5, 0.8, 1], "specularFactor": [0, 0, 0]}, False),
        ({"diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.8, 0.2]}, True),
        ({"diffuseFactor": [0.1, 0, 0, 1], "specularFactor": [0.5] * 3}, True),
        ({"specularFactor": [1, 1, 1], "glossinessFactor": 0.5}, False),
        ({}, True),
    ],
)
def test_specular_surfaces_as_another_reader_converts_them(
    tmp_path: Path, surface: dict[str, Any], reflects: bool
) -> None:
    file = one_square()
    file.json["meshes"][0]["primitives"][0]["material"] = file.add(
        "materials", extensions={"KHR_materials_pbrSpecularGlossiness": surface}
    )
    found = nodes(file.gltf(), Path("a.gltf"))[0].material
    scene = trimesh.load_scene(file.write(tmp_path / "a.glb"), process=False)
    (mesh,) = scene.geometry.values()
    theirs = mesh.visual.material
    assert found.colour == pytest.approx(np.array(theirs.baseColorFactor)[:3] / 255, abs=1 / 254)
    mirror = theirs.metallicFactor >= 0.9 and theirs.roughnessFactor <= 0.3
    assert found.reflects == mirror == reflects
