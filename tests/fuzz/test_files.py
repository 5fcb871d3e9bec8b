"""Any NFF, mesh or workload file is read, or refused in one line that names it."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import trimesh
from fuzzing import answered, changed_words, damaged, examples
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

# ruff: noqa: E501, RUF001, SIM905
NUMBERS = st.sampled_from(
    "0 1 -1 2 3 4 5 0.5 nan inf -inf 1e400 -1e400 1e30 1e31 -1e30 1e-30 5e-324 1e-400 1e300 0x10 1_0 １ "
    "1e 1e+ . - + 999999999999 2147483648 9223372036854775808 179.9999999 180 1,5".split()
)
NFF = """
v
from 0 -5 1
at 0 0 0
up 0 0 1
angle 45
hither 1
resolution 8 8
b 0.1 0.2 0.3
l 5 -5 5
l -5 -5 5 0.5 0.5 1
f 1 0.5 0 0.5 0.5 3 0.5 1.4
s 0 0 0 1
c 1 1 0 0.5 1 1 2 0.25
p 5
-2 -2 -1
2 -2 -1
0 0 -1
2 2 -1
-2 2 -1
pp 3
0 0 0 0 0 1
1 0 0 0 0 1
0 1 0 0 1 1
"""
NFF_WORDS = NUMBERS | st.sampled_from(
    "v from at up angle hither resolution b l f s c p pp # \n é \0 \u2028".split(" ")
)
CONFIG = "picture: {resolution: 4, max_depth: 3}\nprocessors: 4\nscene: "


def read_or_refused(command: str, file: str) -> None:
    """Listed and then run, with a picture where there is geometry; refused in words that name it."""
    listed = answered(command, file)
    if listed.exit_code:
        assert file[:2] in listed.stderr  # with the cut, or the table of objects beside it
    Path("c.yaml").write_text(CONFIG + file)
    run = answered("run", "c.yaml", *(["--picture", "p.png"] if command == "scene" else []))
    assert run.exit_code in (0, 2) if listed.exit_code == 0 else run.exit_code == 2


# --- NFF ---


@examples(40)
@given(data=st.data())
def test_nff_with_words_changed(data: st.DataObject) -> None:
    words = NFF.replace("\n", " \n ").split(" ")
    Path("a.nff").write_text(changed_words(data, words, NFF_WORDS), encoding="utf-8")
    read_or_refused("scene", "a.nff")


@examples(60)
@given(data=st.data())
def test_any_bytes_for_nff(data: st.DataObject) -> None:
    Path("a.nff").write_bytes(damaged(data, NFF.encode()))
    read_or_refused("scene", "a.nff")


# --- meshes ---


def exported(kind: str, **options: Any) -> bytes:
    boxes = trimesh.util.concatenate(
        [trimesh.creation.box(extents=(1, 1, 1)), trimesh.creation.icosahedron()]
    )
    content = boxes.export(file_type=kind, **options)
    return content.encode() if isinstance(content, str) else bytes(content)


MESHES = {
    "obj": exported("obj"),
    "ply": exported("ply", encoding="ascii"),
    "stl": exported("stl_ascii"),
    "off": exported("off"),
}
BINARY = {"glb": exported("glb"), "stl": exported("stl"), "ply": exported("ply")}
MESH_WORDS = NUMBERS | st.sampled_from(
    [
        "v", "f", "vn", "vt", "o", "g", "usemtl x", "mtllib x", "f 1 2", "f 1 2 3 4 5", "f 1 2 999", "f 0 1 2",
        "f -1 -2 -3", "f 1//1 2//2 3//3", "v 1 2", "v 1 2 3 4 5 6 7", "facet", "normal", "outer", "loop",
        "vertex", "endloop", "endfacet", "endsolid", "solid", "element", "property", "list", "uchar", "int",
        "float", "double", "end_header", "format ascii 1.0", "binary_big_endian", "OFF", "\n", "#", "é",
    ]
)  # fmt: skip


@examples(40)
@given(data=st.data())
def test_meshes_with_words_changed(data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from(sorted(MESHES)))
    words = MESHES[kind].decode().replace("\n", " \n ").split(" ")
    Path(f"a.{kind}").write_text(changed_words(data, words, MESH_WORDS), encoding="utf-8")
    cut = data.draw(st.sampled_from(["", ":nodes", ":components", ":3"]))
    read_or_refused("scene", f"a.{kind}{cut}")


@examples(30)
@given(data=st.data())
def test_any_bytes_for_a_mesh(data: st.DataObject) -> None:
    kind, content = data.draw(st.sampled_from([*BINARY.items(), *MESHES.items()]))
    Path(f"a.{kind}").write_bytes(damaged(data, content))
    read_or_refused("scene", f"a.{kind}")


# --- workloads ---

RAYS: dict[str, Any] = {
    "parent": [-1, 0, 3, 0, -1],
    "kind": ["primary", "shadow", "shadow", "reflected", "primary"],
    "pixel": [1, -1, -1, -1, 0],
    "hit": [0, -1, -1, 2, -1],
    "distance": [1.0, 0.0, 0.0, 2.0, 0.0],
}
OFFSETS, TESTS = [0, 2, 3, 5, 7, 7], [1, 0, 0, 2, 1, 1, 2]
OBJECTS: dict[str, Any] = {
    "bytes": [100, 200, 300],
    "kind": ["sphere", "polygon", "mesh"],
    "triangles": [0, 2, 50],
    "test_ps": [1000, 10**13, 0],
    "x": [0.0, 1.0, 2.0], "y": [0.5, 0.5, 0.5], "z": [3.0, 2.0, 1.0],
}  # fmt: skip
INTEGERS = st.integers(-2, 6) | st.sampled_from(
    [2**31 - 1, 2**31, 2**40, 2**40 + 1, 2**62, 2**63 - 1, -(2**63), 10**13, 10**13 + 1]
)
FLOATS = st.floats() | st.sampled_from([1e308, -1e308, 5e-324, 1e-310, 1e200])
CELLS = INTEGERS | FLOATS | st.text(max_size=3) | st.booleans()


def column(data: st.DataObject, n: int) -> np.ndarray:
    """n cells of one type, or of any."""
    cells = data.draw(st.sampled_from([INTEGERS, FLOATS, st.text(max_size=3), CELLS]))
    return np.array(data.draw(st.lists(cells, min_size=n, max_size=n)))


def tables(data: st.DataObject) -> tuple[dict[str, Any], list[int], list[int], dict[str, Any]]:
    """Rays, offsets and tests, objects, with some columns changed."""
    rays, objects = dict(RAYS), dict(OBJECTS)
    for table, n in ((rays, 5), (objects, 3)):
        for name in data.draw(st.sets(st.sampled_from(sorted(table)), max_size=2)):
            if data.draw(st.booleans()):
                del table[name]
            else:
                table[name] = column(data, data.draw(st.just(n) | st.integers(0, 6)))
    offsets, tests = list(OFFSETS), list(TESTS)
    for numbers in (offsets, tests):
        if not data.draw(st.integers(0, 3)):
            numbers[data.draw(st.integers(0, len(numbers) - 1))] = data.draw(INTEGERS)
    return rays, offsets, tests, objects


@examples(40)
@given(data=st.data())
def test_npz_with_columns_changed(data: st.DataObject) -> None:
    rays, offsets, tests, objects = tables(data)
    named = {f"ray_{k}": v for k, v in rays.items()} | {
        f"object_{k}": v for k, v in objects.items()
    }
    if data.draw(st.booleans()):
        named["picture"] = column(data, 2) if data.draw(st.booleans()) else np.array([1, 2])
    np.savez("a.npz", itinerary_offsets=offsets, itinerary_objects=tests, **named)
    read_or_refused("workload", "a.npz")


@examples(30)
@given(data=st.data())
def test_parquet_with_columns_changed(data: st.DataObject) -> None:
    rays, _, tests, objects = tables(data)
    cuts = data.draw(st.lists(st.integers(0, len(tests)), min_size=4, max_size=4).map(sorted))
    itinerary = [part.tolist() for part in np.split(np.array(tests, dtype=object), cuts)]
    for file, columns in (
        ("a.parquet", rays | {"itinerary": itinerary}),
        ("a.objects.parquet", objects),
    ):
        arrays = {}
        for name, cells in columns.items():
            try:
                arrays[name] = pa.array(list(cells))
            except (pa.ArrowException, OverflowError):
                arrays[name] = pa.array([str(cell) for cell in cells])
        if len({len(array) for array in arrays.values()}) > 1:
            return
        parquet.write_table(pa.table(arrays), file)
    read_or_refused("workload", "a.parquet")


@examples(30)
@given(data=st.data(), suffix=st.sampled_from(["npz", "parquet", "objects.parquet"]))
def test_any_bytes_for_a_workload(data: st.DataObject, suffix: str) -> None:
    named = {f"ray_{k}": v for k, v in RAYS.items()} | {
        f"object_{k}": v for k, v in OBJECTS.items()
    }
    np.savez("a.npz", itinerary_offsets=OFFSETS, itinerary_objects=TESTS, **named)
    itinerary = [TESTS[low:high] for low, high in pairwise(OFFSETS)]
    parquet.write_table(pa.table(RAYS | {"itinerary": itinerary}), "a.parquet")
    parquet.write_table(pa.table(OBJECTS), "a.objects.parquet")
    file = Path(f"a.{suffix}")
    file.write_bytes(damaged(data, file.read_bytes()))
    read_or_refused("workload", "a.npz" if suffix == "npz" else "a.parquet")
