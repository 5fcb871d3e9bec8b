"""Features of glTF are read as the format says, and as another reader reads them."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote_from_bytes

import numpy as np
import pytest
import trimesh
from gltf_features import FEATURES, UNIT, instanced, moved
from gltf_files import File, nodes, one_square

from simmpp.scene.scene import Floats


def triangles(data: bytes, file: Path = Path("a.gltf")) -> Floats:
    found = nodes(data, file)
    return np.concatenate([node.vertices[node.faces] for node in found] or [np.zeros((0, 3, 3))])


TRIMESH_READS = {
    *("plain", "no indices", "indices of 8 bits", "indices of 16 bits", "indices of 32 bits"),
    *("interleaved", "integers of 8 bits", "unsigned of 16 bits", "strip", "tree", "mirrored"),
    *(
        "one mesh in two nodes",
        "the scene that is named",
        "the first scene",
        "not morphed",
        "painted",
    ),
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


def test_names_of_two_primitives() -> None:
    file = File()
    file.node(name="n", mesh=file.mesh(file.square(mode=0), file.square()))
    (node,) = nodes(file.gltf(), Path("a.gltf"))
    assert node.name == "n.1"


def test_names_of_instances() -> None:
    found = nodes(instanced().gltf(), Path("a.gltf"))
    assert [node.name for node in found] == ["0[0]", "0[1]", "0[2]"]
