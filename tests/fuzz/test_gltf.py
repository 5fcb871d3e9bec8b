"""Any glTF or GLB is read, or refused in one line: bytes and JSON damaged in every way."""

from __future__ import annotations

import json
import warnings
from copy import copy
from pathlib import Path
from typing import Any

from fuzzing import LONGEST_LINE, TRIED, alarm, damaged, examples
from gltf_features import FEATURES
from gltf_files import glb
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


WHOLE = [build() for build, _ in FEATURES.values()]
TEXTS = [json.loads(file.gltf()) for file in WHOLE]


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


@examples(2500)
@given(data=st.data())
def test_json_with_something_changed(data: st.DataObject) -> None:
    text = json.dumps(changed(data, data.draw(st.sampled_from(TEXTS)))).encode()
    if data.draw(st.booleans()):
        read_or_refused("a.gltf", text)
    else:
        read_or_refused("a.glb", glb(text))


@examples(2500)
@given(data=st.data())
def test_any_bytes(data: st.DataObject) -> None:
    file = data.draw(st.sampled_from(WHOLE))
    kind = data.draw(st.sampled_from(["text", "container", "buffer"]))
    if kind == "text":
        read_or_refused("a.gltf", damaged(data, file.gltf()))
    elif kind == "container":
        read_or_refused("a.glb", damaged(data, file.glb()))
    else:
        other = copy(file)
        buffer = damaged(data, bytes(file.data))
        other.data = bytearray(buffer) + file.data[len(buffer) :]
        read_or_refused("a.glb", other.glb())
