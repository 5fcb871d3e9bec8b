"""Any glTF or GLB is read, or refused in one line: bytes and JSON damaged in every way."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from fuzzing import LONGEST_LINE, TRIED, alarm, damaged, examples
from gltf_files import File, glb, one_square
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.errors import SceneError
from simmpp.scene.mesh import load_mesh

# ruff: noqa: SIM905
NUMBERS = st.integers(-1, 13) | st.sampled_from(
    [float(n) for n in "0.5 5121 5123 5126 65535 2e9 1e30 1e31 -1e30 5e-324 inf nan".split()]
)
WORDS = st.sampled_from(
    "2.0 VEC3 SCALAR POSITION data:, data:;base64,AAAA a.bin %00 é EXT_mesh_gpu_instancing".split()
) | st.sampled_from(["KHR_draco_mesh_compression", "", "\n", "x" * 2000])
VALUES = st.recursive(
    NUMBERS | WORDS | st.none() | st.booleans(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(WORDS, inner, max_size=2),
    max_leaves=4,
)


def everything() -> File:
    """A file with one of each of what is read."""
    file = one_square(scale=[-1, 2, 1], rotation=[0, 0, 0.6, 0.8], translation=[1, 2, 3])
    first = file.json["meshes"][0]["primitives"][0]
    first |= {"targets": [{"POSITION": file.accessor([(0, 0, 1)] * 4)}], "material": 0}
    file.json["meshes"][0]["weights"] = [0.5]
    file.add(
        "materials", pbrMetallicRoughness={"baseColorFactor": [1, 0, 0, 1], "metallicFactor": 1}
    )
    strip = file.square(mode=5, indices=file.accessor([0, 1, 3, 2], "u1"))
    strip["attributes"]["COLOR_0"] = file.accessor([(255, 0, 0, 255)] * 4, "u1")
    sparse = file.json["accessors"][strip["attributes"]["POSITION"]]
    indices = {"bufferView": file.view(np.array([1, 3], "<u2").tobytes()), "componentType": 5123}
    values = {"bufferView": file.view(np.array([(2, 0, 0), (0, 2, 0)], "<f4").tobytes())}
    sparse["sparse"] = {"count": 2, "indices": indices, "values": values}
    moves = {"attributes": {"TRANSLATION": file.accessor([(5, 0, 0), (0, 5, 0)])}}
    child = file.node(
        root=False,
        mesh=file.mesh(strip, file.square(mode=6)),
        extensions={"EXT_mesh_gpu_instancing": moves, "KHR_node_visibility": {"visible": True}},
    )
    matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 9, 0, 0, 1]
    file.node(matrix=matrix, children=[child], name="above")
    file.json["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    return file


WHOLE = everything()
TEXT = json.loads(WHOLE.gltf())
BINARY = WHOLE.glb()
BINARY_TEXT = json.dumps(
    json.loads(BINARY[20 : 20 + int.from_bytes(BINARY[12:16], "little")])
).encode()


def places(node: Any) -> list[tuple[Any, Any]]:
    """Every place in JSON: what holds it, and its key there."""
    keys = node.keys() if isinstance(node, dict) else range(len(node))
    own = [(node, key) for key in keys]
    inner = [node[key] for key in keys if isinstance(node[key], dict | list)]
    return own + [place for part in inner for place in places(part)]


def changed(data: st.DataObject, tree: Any) -> Any:
    """JSON with a few things replaced, taken out, put twice or exchanged."""
    tree = json.loads(json.dumps(tree))
    for _ in range(data.draw(st.sampled_from([1, 1, 1, 2, 3]))):
        found = places(tree)
        holder, key = found[data.draw(st.integers(0, len(found) - 1))]
        way = data.draw(st.integers(0, 6))
        if way == 0:
            del holder[key]
        elif way == 1 and isinstance(holder, list):
            holder.append(holder[key])
        elif way == 2:
            other, at = found[data.draw(st.integers(0, len(found) - 1))]
            holder[key] = json.loads(json.dumps(other[at]))
        elif way < 5 and type(holder[key]) in (int, float):
            holder[key] += data.draw(st.sampled_from([-1, 1, 0.25]))
        else:
            holder[key] = data.draw(VALUES)
    return tree


def read_or_refused(name: str, content: bytes) -> None:
    file = Path(name)
    file.write_bytes(content)
    with alarm(), warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            scene = load_mesh(file)
        except SceneError as error:
            TRIED[f"{file.suffix[1:]}: refused"] += 1
            assert str(error).startswith(f"{name}: ") and len(str(error)) < LONGEST_LINE
            assert str(error).isprintable()
        else:
            TRIED[f"{file.suffix[1:]}: read"] += 1
            assert scene.objects


def test_what_is_not_damaged_is_read() -> None:
    read_or_refused("a.gltf", WHOLE.gltf())
    assert len(load_mesh("a.gltf", objects="nodes").objects) == 5


@examples(2500)
@given(data=st.data())
def test_json_with_something_changed(data: st.DataObject) -> None:
    text = json.dumps(changed(data, TEXT)).encode()
    if data.draw(st.booleans()):
        read_or_refused("a.gltf", text)
    else:
        read_or_refused("a.glb", glb(text, bytes(WHOLE.data)))


@examples(2500)
@given(data=st.data())
def test_any_bytes(data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from(["text", "container", "buffer"]))
    if kind == "text":
        read_or_refused("a.gltf", damaged(data, WHOLE.gltf()))
    elif kind == "container":
        read_or_refused("a.glb", damaged(data, BINARY))
    else:
        buffer = damaged(data, bytes(WHOLE.data))[: len(WHOLE.data)].ljust(len(WHOLE.data), b"\1")
        read_or_refused("a.glb", glb(BINARY_TEXT, buffer))
