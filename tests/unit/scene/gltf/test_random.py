"""Random accessors and trees, against the plainest reading of the format: number by number."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import CODES, File, nodes
from hypothesis import given
from hypothesis import strategies as st

FORMATS = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "f4": "f"}
RANGES = {"i1": (-128, 127), "u1": (0, 255), "i2": (-32768, 32767), "u2": (0, 65535)}


def stored(kind: str) -> st.SearchStrategy[Any]:
    if kind == "f4":
        return st.floats(-1000, 1000, width=32)
    return st.integers(*RANGES[kind])


def meaning(value: float, kind: str, *, normalized: bool) -> float:
    if kind == "f4" or not normalized:
        return float(value)
    return max(value / RANGES[kind][1], -1.0)


@given(st.data())
def test_any_layout_of_an_accessor(data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from(sorted(FORMATS)))
    count = data.draw(st.integers(3, 8))
    rows = data.draw(st.lists(st.tuples(*[stored(kind)] * 3), min_size=count, max_size=count))
    pack = struct.Struct(f"<3{FORMATS[kind]}")
    gap, start, inner = (data.draw(st.integers(0, 9)) for _ in range(3))
    has_view = data.draw(st.booleans())
    normalized = data.draw(st.booleans())
    file = File()
    accessor: dict[str, Any] = {"type": "VEC3", "componentType": CODES[kind], "count": count}
    if has_view:
        content = b"".join(pack.pack(*row) + b"\xaa" * gap for row in rows)
        stride = {"byteStride": pack.size + gap} if gap else {}
        file.data += b"\xbb" * start
        view = file.view(b"\xcc" * inner + content, **stride)
        accessor |= {"bufferView": view, "byteOffset": inner}
    else:
        rows = [(0, 0, 0)] * count
    places = sorted(data.draw(st.sets(st.integers(0, count - 1))))
    if places:
        wide = data.draw(st.sampled_from(["u1", "u2", "u4"]))
        changed = [data.draw(st.tuples(*[stored(kind)] * 3)) for _ in places]
        packed = np.array(places, f"<{wide}").tobytes()
        indices = {"bufferView": file.view(packed), "componentType": CODES[wide]}
        values = {"bufferView": file.view(b"".join(pack.pack(*row) for row in changed))}
        accessor["sparse"] = {"count": len(places), "indices": indices, "values": values}
        for place, row in zip(places, changed, strict=True):
            rows[place] = row
    index = file.add("accessors", **accessor, normalized=normalized)
    file.node(mesh=file.mesh({"attributes": {"POSITION": index}, "mode": 6}))
    for content, name in ((file.gltf(), "a.gltf"), (file.glb(), "a.glb")):
        (node,) = nodes(content, Path(name))
        expected = [[meaning(v, kind, normalized=normalized) for v in row] for row in rows]
        np.testing.assert_array_equal(node.vertices, expected)
        assert node.faces.tolist() == [[i, i + 1, 0] for i in range(1, count - 1)]


# --- trees ---

CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
SIZES = st.floats(0.25, 4) | st.floats(-4, -0.25)
VECTORS = st.tuples(*[st.floats(-9, 9)] * 3)
QUATERNIONS = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: sum(v * v for v in q) > 0.01)


def turned(quaternion: Any, point: Any) -> np.ndarray:
    """By Rodrigues' formula, around the axis of the quaternion."""
    *axis, w = np.array(quaternion) / np.linalg.norm(quaternion)
    sideways = 2 * np.cross(axis, point)
    return point + w * sideways + np.cross(axis, sideways)


def applied(node: dict[str, Any], point: np.ndarray) -> np.ndarray:
    if "matrix" in node:
        return (np.array(node["matrix"]).reshape(4, 4).T @ [*point, 1])[:3]
    point = point * node.get("scale", (1, 1, 1))
    point = turned(node.get("rotation", (0, 0, 0, 1)), point)
    return point + node.get("translation", (0, 0, 0))


@st.composite
def transformations(draw: st.DrawFn) -> dict[str, Any]:
    if draw(st.booleans()):
        columns = [draw(SIZES) if i % 5 == 0 else draw(st.floats(-0.1, 0.1)) for i in range(16)]
        columns[3::4] = 0, 0, 0, 1
        return {"matrix": columns}
    parts = {"scale": st.tuples(*[SIZES] * 3), "rotation": QUATERNIONS, "translation": VECTORS}
    return {name: draw(values) for name, values in parts.items() if draw(st.booleans())}


@given(st.data())
def test_any_tree(data: st.DataObject) -> None:
    """Nodes in any order, with a mesh or without, are where each step upwards takes their mesh."""
    n = data.draw(st.integers(1, 8))
    above = [data.draw(st.integers(-1, i - 1)) for i in range(n)]
    order = data.draw(st.permutations(range(n)))
    parents = {order[i]: order[above[i]] if above[i] >= 0 else None for i in range(n)}
    file = File()
    corners = {"attributes": {"POSITION": file.accessor(CORNERS)}}
    mesh = file.mesh(corners | {"indices": file.accessor(np.ravel(FACES), "u1")})
    has_mesh = [data.draw(st.booleans()) for _ in range(n)]
    for i in range(n):
        children = [child for child, parent in parents.items() if parent == i]
        entry = data.draw(transformations()) | ({"children": children} if children else {})
        file.node(root=parents[i] is None, **entry, **({"mesh": mesh} if has_mesh[i] else {}))
    found = nodes(file.gltf(), Path("a.gltf"))
    assert [node.name for node in found] == [str(i) for i in range(n) if has_mesh[i]]
    for node in found:
        expected = [np.array(corner) for corner in CORNERS]
        at: int | None = int(node.name)
        while at is not None:
            expected = [applied(file.json["nodes"][at], point) for point in expected]
            at = parents[at]
        np.testing.assert_allclose(node.vertices, expected, rtol=1e-9, atol=1e-6)
        a, b, c = (node.vertices[node.faces[:, k]] for k in range(3))
        volume = (np.cross(a, b) * c).sum() / 6
        assert volume == pytest.approx(abs(volume), rel=1e-6), "inside out"
