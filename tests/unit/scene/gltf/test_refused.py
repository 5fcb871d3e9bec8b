"""What is damaged or not read is refused in one line that names the place in the file."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_features import instanced as instanced_squares
from gltf_files import SQUARE, File, nodes, one_square, refused

from simmpp.scene.gltf import accessors, read

Change = Callable[[dict[str, Any]], Any]
DRACO = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}


def needs(name: str) -> Change:
    return lambda json: json.update(extensionsRequired=[name])


def primitive(**values: Any) -> Change:
    return lambda json: json["meshes"][0]["primitives"][0].update(values)


def entry(collection: str, index: int = 0, **values: Any) -> Change:
    return lambda json: json[collection][index].update(values)


def without(collection: str, index: int, key: str) -> Change:
    return lambda json: json[collection][index].pop(key)


def at_root(**values: Any) -> Change:
    return lambda json: json.update(values)


def more_nodes(*others: dict[str, Any], **first: Any) -> Change:
    def change(json: dict[str, Any]) -> None:
        json["nodes"] += others
        json["nodes"][0].update(first)

    return change


def sparse(**values: Any) -> Change:
    """A sparse accessor on top of the positions: index 0 in 2 bytes, of the indices' own view."""
    indices = {"bufferView": 1, "componentType": 5123} | values.pop("indices", {})
    whole = {"count": 1, "indices": indices, "values": {"bufferView": 0}} | values
    return entry("accessors", sparse=whole)


def morphed(weights: list[float], count: int = 4) -> Change:
    def change(json: dict[str, Any]) -> None:
        json["accessors"].append(json["accessors"][0] | {"count": count})
        json["meshes"][0]["weights"] = weights
        primitive(targets=[{"POSITION": 2}])(json)

    return change


def instanced(**attributes: int) -> Change:
    return entry("nodes", extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})


REFUSED: dict[str, tuple[Change, str]] = {
    # what is not read
    "draco": (
        needs("KHR_draco_mesh_compression"),
        "compressed with Draco, which is not read: save",
    ),
    "draco, no data": (
        lambda json: (
            primitive(extensions=DRACO)(json),
            without("accessors", 0, "bufferView")(json),
        ),
        "meshes[0].primitives[0]: compressed with Draco, which is not read: save it without",
    ),
    "meshopt": (needs("EXT_meshopt_compression"), "compressed with meshopt, which is not read"),
    "meshopt, new": (needs("KHR_meshopt_compression"), "compressed with meshopt"),
    "skin": (entry("nodes", skin=0), "nodes[0]: its mesh is bent by a skin, which is not read"),
    "unknown": (needs("ACME_geometry"), "needs the extension 'ACME_geometry', which is not read"),
    "glTF 1": (at_root(asset={"version": "1.0"}), "of glTF '1.0', for readers of '2.0' at least"),
    "glTF 3": (at_root(asset={"version": "3.0"}), "expected glTF 2.0, save it as that"),
    "glTF 2.1 only": (at_root(asset={"version": "2.1", "minVersion": "2.1"}), "'2.1' at least"),
    # the tree
    "cycle": (more_nodes({"children": [0]}, children=[1]), "nodes[1] is below itself"),
    "itself": (entry("nodes", children=[0]), "nodes[0] is below itself"),
    "apart": (more_nodes({"children": [2]}, {"children": [1]}), "nodes[2] is below itself"),
    "two parents": (
        more_nodes({"children": [3]}, {"children": [3]}, {}),
        "nodes[3] is a child of nodes[1] and of nodes[2]: expected trees",
    ),
    "twice a child": (more_nodes({"children": [2, 2]}, {}), "nodes[2] is a child of nodes[1] and"),
    "no root": (more_nodes({"children": [0]}), "nodes[0] is a root of the scene, and a child of"),
    "twice a root": (entry("scenes", nodes=[0, 0]), "nodes[0] is in its scene twice"),
    "no such child": (entry("nodes", children=[7]), "nodes[7] is named, but there are 1 nodes"),
    "no such root": (entry("scenes", nodes=[7]), "nodes[7] is named, but there are 1 nodes"),
    "no such scene": (at_root(scene=2), "scenes[2] is named, but there are 1 scenes"),
    "no such mesh": (entry("nodes", mesh=1), "meshes[1] is named, but there are 1 meshes"),
    "matrix and scale": (
        entry("nodes", matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], scale=[1, 1, 1]),
        "nodes[0] has a matrix and also a translation, rotation or scale",
    ),
    "perspective": (entry("nodes", matrix=[1] * 16), "nodes[0].matrix: expected the last row 0 0"),
    "no rotation": (entry("nodes", rotation=[0, 0, 0, 0]), "a rotation is 0 0 0 0"),
    "short matrix": (entry("nodes", matrix=[1]), "nodes[0].matrix: value: List should have at"),
    "endless": (entry("nodes", scale=[1, 1, 1e999]), "nodes[0].scale[2]: value inf: expected a"),
    # meshes
    "no position": (primitive(attributes={}), "meshes[0].primitives[0]: no POSITION"),
    "no such accessor": (primitive(indices=5), "accessors[5] is named, but there are 2 accessors"),
    "no such material": (primitive(material=0), "materials[0] is named, but there are 0 materials"),
    "mode": (primitive(mode=7), "meshes[0].primitives[0].mode: value 7: expected less than or"),
    "two corners": (entry("accessors", 1, count=2), "2 corners are not whole triangles"),
    "five corners": (entry("accessors", 1, count=5), "5 corners are not whole triangles"),
    "strip of two": (
        lambda json: (primitive(mode=5)(json), entry("accessors", 1, count=2)(json)),
        "2 corners are not whole triangles",
    ),
    "index": (
        entry("accessors", 0, count=3),
        "a triangle names vertex 3, but there are 3 vertices",
    ),
    "signed indices": (entry("accessors", 1, componentType=5122), "indices are not unsigned"),
    "float indices": (entry("accessors", 1, componentType=5126), "indices are not unsigned"),
    "positions of 4": (entry("accessors", type="VEC4"), "type: value 'VEC4': expected VEC3"),
    "weights": (morphed([1, 2]), "2 weights for 1 morph targets"),
    "short target": (morphed([1], count=3), "a morph target of 3 for 4 vertices"),
    "short colours": (
        lambda json: (
            json["accessors"].append(json["accessors"][0] | {"count": 3}),
            primitive(attributes={"POSITION": 0, "COLOR_0": 2})(json),
        ),
        "3 colours for 4 vertices",
    ),
    "instances of none": (instanced(), "expected TRANSLATION, ROTATION and SCALE of one count"),
    "instances of two counts": (
        lambda json: (
            json["accessors"].append(json["accessors"][0] | {"count": 3}),
            instanced(TRANSLATION=0, SCALE=2)(json),
        ),
        "EXT_mesh_gpu_instancing: expected TRANSLATION, ROTATION and SCALE of one count",
    ),
    # accessors, views, buffers
    "component": (
        entry("accessors", componentType=5124),
        "componentType: value 5124: expected one",
    ),
    "count of 0": (entry("accessors", count=0), "accessors[0].count: value 0: expected greater"),
    "beyond the view": (entry("accessors", count=5), "accessors[0] ends at byte 60 of its view,"),
    "hostile count": (entry("accessors", count=2**52), "accessors[0] ends at byte 5404319552844"),
    "hostile zeros": (
        lambda json: (
            without("accessors", 0, "bufferView")(json),
            entry("accessors", count=2**52)(json),
        ),
        "accessors[0]: 4503599627370496 elements without a bufferView, more than",
    ),
    "a byte beyond the view": (entry("bufferViews", byteLength=47), "ends at byte 48 of its view,"),
    "a byte beyond the buffer": (
        entry("buffers", byteLength=59),
        "bufferViews[1] ends at byte 60 of buffers[0], which has 59",
    ),
    "no number that JSON keeps": (
        entry("accessors", count=2**53),
        "accessors[0].count: value 9007199254740992: expected less than 9007199254740992",
    ),
    "characters of base64": (
        entry("buffers", uri="data:;base64,AA*A"),
        "buffers[0]: not base64: Only base64 data is allowed",
    ),
    "stride": (entry("bufferViews", byteStride=8), "elements of 12 bytes, 8 bytes apart"),
    "no such view": (entry("accessors", bufferView=9), "bufferViews[9] is named, but there are 2"),
    "beyond the buffer": (
        entry("bufferViews", 1, byteLength=99),
        "bufferViews[1] ends at byte 147",
    ),
    "no such buffer": (entry("bufferViews", buffer=1), "buffers[1] is named, but there are 1"),
    "short buffer": (entry("buffers", byteLength=99), "buffers[0]: 99 bytes are named, but there"),
    "no uri": (without("buffers", 0, "uri"), "buffers[0] has neither a uri nor a chunk of a GLB"),
    "no file": (
        entry("buffers", uri="no%20where.bin"),
        "buffers[0]: can't read 'no where.bin': No",
    ),
    "a folder": (entry("buffers", uri="."), "buffers[0]: can't read '.': Is a directory"),
    "null byte": (entry("buffers", uri="%00"), "buffers[0]: can't read '\\x00': embedded null"),
    "elsewhere": (
        entry("buffers", uri="https://a/b.bin"),
        "buffers[0] is at 'https://a/b.bin': exp",
    ),
    "base64": (
        entry("buffers", uri="data:;base64,AAA"),
        "buffers[0]: not base64: Incorrect padding",
    ),
    "no comma": (entry("buffers", uri="data:;base64"), "buffers[0]: its data: URI has no comma"),
    "sparse beyond": (sparse(count=7), "accessors[0].sparse ends at byte 14 of its view"),
    "sparse twice": (
        sparse(count=2, indices={"componentType": 5121}),
        "its indices don't ascend, or go",
    ),
    "sparse falling": (sparse(count=2, indices={"byteOffset": 4}), "its indices don't ascend, or"),
    "sparse too high": (
        lambda json: (sparse(indices={"byteOffset": 10})(json), entry("accessors", count=3)(json)),
        "accessors[0].sparse: its indices don't ascend, or go beyond 2",
    ),
    "sparse floats": (sparse(indices={"componentType": 5126}), "sparse: its indices are not unsig"),
    # kinds of values
    "text for a number": (
        entry("accessors", count="4"),
        "accessors[0].count: value '4': expected a",
    ),
    "negative": (
        primitive(indices=-1),
        "meshes[0].primitives[0].indices: value -1: expected great",
    ),
    "a fraction": (at_root(scene=0.5), "scene: value 0.5: expected a valid integer"),
    "a flag": (at_root(scene=True), "scene: value true: expected a valid integer"),
    "no version": (at_root(asset={}), "asset.version: missing"),
    "a number as a name": (
        entry("nodes", name=7),
        "nodes[0].name: value 7: expected a valid string",
    ),
    "a list for a mesh": (at_root(meshes=[[]]), "meshes[0]: value: expected a valid object"),
    "a mesh for meshes": (at_root(meshes={}), "meshes: value: expected a valid list"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str) -> None:
    change, problem = REFUSED[name]
    file = one_square()
    file.json["buffers"] = [{"byteLength": len(file.data), "uri": "data:," + "%00" * 48 + TAIL}]
    change(file.json)
    assert problem in refused(file.gltf())


TAIL = "".join(f"%{byte:02x}" for byte in np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes())


def test_an_index_that_stands_for_no_vertex() -> None:
    file = File()
    attributes = {"POSITION": file.accessor(SQUARE * 64)}
    indices = file.accessor([0, 1, 255], "u1")
    file.node(mesh=file.mesh({"attributes": attributes, "indices": indices}))
    assert "accessors[1]: the index 255 stands for no vertex" in refused(file.gltf())


def test_a_hostile_file_takes_no_memory() -> None:
    changes = [
        REFUSED["hostile count"][0],
        REFUSED["hostile zeros"][0],
        entry("buffers", byteLength=2**52),
    ]
    for change in changes:
        file = one_square()
        file.json["buffers"] = [{"byteLength": len(file.data), "uri": __file__.replace("%", "%25")}]
        change(file.json)
        tracemalloc.start()
        refused(file.gltf())
        assert tracemalloc.get_traced_memory()[1] < 2**22
        tracemalloc.stop()


@pytest.mark.parametrize(("limit", "each"), [("MOST_TRIANGLES", 2), ("MOST_OBJECTS", 1)])
def test_more_than_memory_holds(monkeypatch: pytest.MonkeyPatch, limit: str, each: int) -> None:
    monkeypatch.setattr(read, limit, 9 * each)
    file = one_square()
    for _ in range(8):
        file.node(mesh=0)
    assert len(nodes(file.gltf(), Path("a.gltf"))) == 9
    file.node(mesh=0)
    assert "its nodes place more than" in refused(file.gltf())
    monkeypatch.setattr(read, limit, 3 * each - 1)
    assert "its nodes place more than" in refused(instanced_squares().gltf())


def test_zeros_that_no_bytes_stand_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(accessors, "MOST_ZEROS", 4)
    file = one_square()
    del file.json["accessors"][0]["bufferView"]
    assert not nodes(file.gltf(), Path("a.gltf"))[0].vertices.any()
    file.json["accessors"][0]["count"] = 5
    assert "5 elements without a bufferView, more than 4 zeros" in refused(file.gltf())
