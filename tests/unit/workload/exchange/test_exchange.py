"""Rays of other renderers: whatever is written comes in as meant, or is refused with its place."""

from __future__ import annotations

import dataclasses
import re
import shutil
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from builders import random_case, workload_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pyarrow import parquet

from simmpp.common.errors import WorkloadError
from simmpp.engine.simulate import simulate
from simmpp.workload.check import check
from simmpp.workload.exchange.exchange import export_workload, import_workload, is_workload
from simmpp.workload.workload import MESH, REFLECTED, REFRACTED, SHADOW, Workload

SUFFIXES = (".parquet", ".npz")

# Two primary rays: the second (row 0) hits objects 1, 0 and spawns a shadow (row 1) and a
# reflection (row 3), which spawns a shadow (row 2). Row 4 is the first pixel's and misses.
RAYS: dict[str, Any] = {
    "itinerary": [[1, 0], [0], [2, 1], [1, 2], []],
    "parent": [-1, 0, 3, 0, -1],
    "kind": ["primary", "shadow", "shadow", "reflected", "primary"],
    "pixel": [1, -1, -1, -1, 0],
}
OBJECTS: dict[str, Any] = {
    "bytes": [100, 200, 300],
    "kind": ["sphere", "polygon", "mesh"],
    "triangles": [0, 2, 50],
    "x": [0.0, 1.0, 2.0],
    "y": [0.5, 0.5, 0.5],
    "z": [3.0, 2.0, 1.0],
}
SMALL = workload_of(
    2,
    [[], [1, 0], [1, 2], [0], [2, 1]],
    parents=[1, 1, 2],
    kinds=[REFLECTED, SHADOW, SHADOW],
    object_bytes=[100, 200, 300],
    object_kinds=[0, 2, 3],
    object_triangles=[0, 2, 50],
)


def write(path: Path, rays: Mapping[str, Any], objects: Mapping[str, Any]) -> Path:
    """The tables as a renderer's author would write them."""
    if path.suffix == ".parquet":
        parquet.write_table(pa.table(dict(rays)), path)
        parquet.write_table(pa.table(dict(objects)), path.with_suffix(".objects.parquet"))
        return path
    columns = dict(rays)
    itineraries = columns.pop("itinerary")
    flat = [o for itinerary in itineraries for o in itinerary]
    np.savez(
        path,
        itinerary_offsets=np.cumsum([0, *map(len, itineraries)]),
        itinerary_objects=np.array(flat, np.int64),
        **{f"ray_{name}": np.array(column) for name, column in columns.items()},
        **{f"object_{name}": np.array(column) for name, column in objects.items()},
    )
    return path


def same(a: Workload, b: Workload, *, but: tuple[str, ...] = ()) -> bool:
    """Every array is equal, with its type."""
    for field in dataclasses.fields(Workload):
        mine, other = getattr(a, field.name), getattr(b, field.name)
        if isinstance(mine, np.ndarray) and field.name not in but:
            np.testing.assert_array_equal(mine, other, err_msg=field.name, strict=True)
    return a.picture == b.picture


def without_picture(workload: Workload) -> Workload:
    """The same rays as a list, which is a picture of one column."""
    return dataclasses.replace(workload, picture=(workload.n_primaries, 1))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_renderers_tables(tmp_path: Path, suffix: str) -> None:
    workload = import_workload(write(tmp_path / f"forest{suffix}", RAYS, OBJECTS))
    assert workload.name == "forest"
    expected = without_picture(SMALL)
    assert same(workload, expected, but=("object_centroids", "hits", "hit_distances"))
    assert workload.hits.tolist() == [-1, 0, 2, -1, -1]  # known of those that spawned others
    assert workload.object_centroids.tolist() == [[0, 0.5, 3], [1, 0.5, 2], [2, 0.5, 1]]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_defaults(tmp_path: Path, suffix: str) -> None:
    rays = {"itinerary": [[0], [1, 0]]}
    workload = import_workload(write(tmp_path / f"a{suffix}", rays, {"bytes": [7, 8]}))
    assert workload.picture == (2, 1)
    assert workload.object_kinds.tolist() == [MESH, MESH]
    assert workload.object_triangles.tolist() == [0, 0]
    assert not workload.object_centroids.any()
    assert len(workload.object_test_ps) == 0
    chain = {"itinerary": [[0], [1], [0]], "parent": [1, -1, 0]}
    chained = import_workload(write(tmp_path / f"b{suffix}", chain, {"bytes": [7, 8]}))
    assert chained.kinds.tolist() == [0, REFLECTED, REFLECTED]


def test_kinds_by_number_and_nulls_for_none(tmp_path: Path) -> None:
    rays = RAYS | {
        "kind": [0, 3, 3, 1, 0],
        "parent": pa.array([None, 0, 3, 0, None], pa.uint16()),
        "hit": pa.array([0, None, None, 2, None], pa.int8()),
    }
    objects = OBJECTS | {"kind": pa.array(OBJECTS["kind"]).dictionary_encode()}
    named = import_workload(write(tmp_path / "a.parquet", RAYS, OBJECTS))
    assert same(import_workload(write(tmp_path / "b.parquet", rays, objects)), named)


def test_siblings_are_ordered_by_kind(tmp_path: Path) -> None:
    rays = {
        "itinerary": [[0], [0], [0], [0], [0]],
        "parent": [-1, 0, 0, 0, 0],
        "kind": ["primary", "shadow", "refracted", "shadow", "reflected"],
    }
    workload = import_workload(write(tmp_path / "a.npz", rays, {"bytes": [1]}))
    assert workload.kinds.tolist() == [0, REFLECTED, REFRACTED, SHADOW, SHADOW]


@pytest.mark.parametrize("suffix", SUFFIXES)
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 10**6))
def test_export_and_import_give_the_same(tmp_path: Path, suffix: str, seed: int) -> None:
    workload = random_case(seed).workload
    spawners = np.diff(workload.child_offsets) > 0
    if workload.n_primaries == 0 or (spawners & (workload.hits < 0)).any():
        return
    path = tmp_path / f"a{suffix}"
    export_workload(workload, path)
    assert same(import_workload(path), workload)


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(seed=st.integers(0, 10**6))
def test_the_order_of_rows_does_not_matter(tmp_path: Path, seed: int) -> None:
    """Rows shuffled, but pixels known and siblings of one kind in their order."""
    workload = random_case(seed).workload
    n, spawners = workload.n_rays, np.diff(workload.child_offsets) > 0
    if workload.n_primaries == 0 or (spawners & (workload.hits < 0)).any():
        return
    rng = np.random.default_rng(seed)
    row = np.arange(n)
    generations = np.searchsorted(np.append(0, np.cumsum(_depths(workload))), row, side="right")
    row = np.lexsort((row, rng.permutation(generations.max() + 1)[generations]))
    number = np.argsort(row)
    cuts = workload.itinerary_offsets
    rays = {
        "itinerary": [workload.itinerary_objects[cuts[r] : cuts[r + 1]].tolist() for r in row],
        "parent": np.where(workload.parents < 0, -1, number[workload.parents])[row],
        "kind": workload.kinds[row],
        "pixel": workload.pixels[row],
        "hit": workload.hits[row],
        "distance": np.where(workload.hits < 0, 0.0, workload.hit_distances)[row],
    }
    objects = {
        "bytes": workload.object_bytes,
        "kind": workload.object_kinds,
        "triangles": workload.object_triangles,
    }
    imported = import_workload(write(tmp_path / "a.npz", rays, objects))
    assert same(imported, without_picture(workload))


def _depths(workload: Workload) -> list[int]:
    from simmpp.workload.describe import rays_by_depth

    return rays_by_depth(workload)


def test_costs_of_objects_replace_the_machines(tmp_path: Path) -> None:
    case = random_case(11)
    machine = case.machine
    costs = machine.test.of_objects(case.workload)
    told = dataclasses.replace(case.workload, object_test_ps=costs + 1000)
    export_workload(told, tmp_path / "a.parquet")
    arguments = (machine, case.placement, case.policy)
    results = [simulate(each, *arguments) for each in (case.workload, told)]
    extra = results[1].compute_ps.sum() - results[0].compute_ps.sum()
    assert results[0].tests > 0
    assert extra == 1000 * results[0].tests
    again = simulate(import_workload(tmp_path / "a.parquet"), *arguments)
    assert again.makespan_ps == results[1].makespan_ps


Change = Callable[[dict[str, Any], dict[str, Any]], None]


def rays(**columns: Any) -> Change:
    return lambda rays, objects: rays.update(columns)


def objects(**columns: Any) -> Change:
    return lambda rays, objects: objects.update(columns)


MISTAKES: list[tuple[Change, str]] = [
    (rays(parent=[-1, 0, 3, 2, -1], kind=[0, 3, 1, 1, 0]),
     "column parent, row 2: value 3: the ray is its own ancestor"),
    (rays(parent=[0, 0, 3, 0, -1]), "column kind, row 0: a primary ray has parent 0"),
    (rays(parent=[-1, 0, 5, 0, -1]), "column parent, row 2: value 5: expected -1 or a row from"),
    (rays(parent=[-1, 0, -2, 0, -1]), "column parent, row 2: value -2: expected -1 or a row"),
    (rays(parent=[-1, 0, 1, 0, -1]), "column parent, row 2: value 1: expected no shadow ray"),
    (rays(parent=[-1.0, 0, 3, 0, -1]), "column parent: it holds float64, expected integers"),
    (rays(parent=[1, 0, 3, 0, 0], kind=[1] * 5), "column parent: there is no primary ray"),
    (rays(kind=["primary", "shade", "shadow", "reflected", "primary"]),
     "column kind, row 1: value 'shade': expected one of primary (0), reflected (1)"),
    (rays(kind=[0, 7, 3, 1, 0]), "column kind, row 1: value 7: expected one of primary (0)"),
    (rays(kind=["primary", "shadow", "shadow", "reflected", "shadow"]),
     "column kind, row 4: a shadow ray has no parent"),
    (rays(pixel=[1, -1, -1, -1, -1]), "column pixel, row 4: value -1: expected a primary"),
    (rays(pixel=[1, 0, -1, -1, 0]), "column pixel, row 1: value 0: its primary ray has another"),
    (rays(itinerary=[[1, 0], [0], [3], [1, 2], []]),
     "column itinerary, row 2: value 3: expected a row of the 3 objects"),
    (rays(itinerary=[[1, 0], [-1], [2], [1, 2], []]), "column itinerary, row 1: value -1: "),
    (rays(itinerary=[[1, 0, 1], [0], [2], [1, 2], []]),
     "column itinerary, row 0: object 1 occurs twice"),
    (rays(itinerary=[[1, 0], [0], [2], [], []]), "column itinerary, row 3: it is empty: a ray"),
    (rays(hit=[2, -1, -1, 2, -1]), "column hit, row 0: value 2: expected an object of the"),
    (rays(hit=[0, 3, -1, 2, -1]), "column hit, row 1: value 3: expected -1 or a row of"),
    (rays(hit=[-1, -1, -1, 2, -1]), "column hit, row 0: value -1: expected an object: the ray"),
    (rays(distance=[1.0, 0, 0, np.nan, 0]), "column distance, row 3: value nan: expected a finite"),
    (rays(distance=[-1.0, 0, 0, 0, 0]), "column distance, row 0: value -1.0: expected a distance"),
    (rays(parnet=[0] * 5), "column parnet: it is unknown: did you mean parent?"),
    (objects(weight=[0] * 3), "column weight: it is unknown: expected one of bytes, kind"),
    (objects(bytes=[1, -2, 3]), "column bytes, row 1: value -2: expected a size from 0 to"),
    (objects(bytes=[1.5, 2.0, 3.0]), "column bytes: it holds float64, expected integers"),
    (objects(bytes=[1, 2, 2**41]), "column bytes, row 2: value 2199023255552: expected a size"),
    (objects(triangles=[0, 2, -1]), "column triangles, row 2: value -1: expected an integer"),
    (objects(test_ps=[0, 10**14, 0]), "column test_ps, row 1: value 100000000000000: expected"),
    (objects(x=[0.0, np.inf, 0]), "column x, row 1: value inf: expected a finite number"),
    (objects(y=[0.0, -1e31, 0]), "column y, row 1: value -1e+31: expected a finite number of"),
    (objects(x=["a", "b", "c"]), "column x: it holds text, expected numbers"),
    (objects(kind=["sphere", "cube", "mesh"]), "column kind, row 1: value 'cube': expected one of"),
]  # fmt: skip


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(("change", "line"), MISTAKES)
def test_mistakes_are_told_by_file_column_and_row(
    tmp_path: Path, suffix: str, change: Change, line: str
) -> None:
    rays, objects = dict(RAYS), dict(OBJECTS)
    change(rays, objects)
    path = write(tmp_path / f"a{suffix}", rays, objects)
    with pytest.raises(WorkloadError) as caught:
        import_workload(path)
    plain = re.sub(r"\b(ray|object)_", "", caught.value.problem)  # the prefixes in an npz
    assert plain.startswith(line)
    assert "\n" not in str(caught.value)
    assert caught.value.where.startswith(str(tmp_path / "a"))


def test_mistakes_of_parquet(tmp_path: Path) -> None:
    def refused(**columns: Any) -> str:
        path = write(tmp_path / "a.parquet", RAYS | columns, OBJECTS)
        with pytest.raises(WorkloadError) as caught:
            import_workload(path)
        return caught.value.problem

    assert refused(itinerary=[[0], None, [0], [0], [0]]) == (
        "column itinerary, row 1: the value is missing (null)"
    )
    assert refused(itinerary=[[0], [0, None], [0], [0], [0]]) == (
        "column itinerary, row 1: an object is missing (null)"
    )
    assert refused(itinerary=[1, 2, 0, 1, 2]).startswith("column itinerary: it holds int64")
    assert refused(kind=["primary", None, "shadow", "shadow", "primary"]) == (
        "column kind, row 1: the value is missing (null)"
    )
    assert refused(parent=pa.array([2**63, 0, 3, 0, 0], pa.uint64())).startswith(
        "column parent, row 0"
    )
    assert refused(pixel=[{"a": 1}] * 5).startswith("column pixel: it holds struct<a: int64>")
    (tmp_path / "a.objects.parquet").unlink()
    with pytest.raises(WorkloadError, match=r"expected the table of objects beside it, a.objects"):
        import_workload(tmp_path / "a.parquet")


def test_files_that_are_none(tmp_path: Path) -> None:
    def refused(path: Path) -> str:
        with pytest.raises(WorkloadError) as caught:
            import_workload(path)
        return caught.value.problem

    for suffix in SUFFIXES:
        path = write(tmp_path / f"a{suffix}", RAYS, OBJECTS)
        path.write_bytes(path.read_bytes()[:-20])
        assert refused(path).startswith("can't be read: ")
        path.write_text("Hello")
        assert refused(path).startswith("can't be read: ")
        path.unlink()
        assert refused(path) == "there is no such file"
    assert refused(tmp_path / "a.csv") == "expected a file .parquet or .npz"
    pickled = tmp_path / "p.npz"
    np.savez(pickled, itinerary_offsets=np.array([{}]), itinerary_objects=[0], allow_pickle=True)
    assert "allow_pickle=False" in refused(pickled)
    np.save(tmp_path / "one.npy", np.zeros(3))
    (tmp_path / "one.npy").rename(tmp_path / "one.npz")
    assert refused(tmp_path / "one.npz") == "expected an npz of several arrays, found one array"
    np.savez(tmp_path / "n.npz", itinerary_offsets=np.zeros((2, 2), int), itinerary_objects=[0])
    assert refused(tmp_path / "n.npz") == "array itinerary_offsets: it has 2 dimensions, expected 1"
    np.savez(
        tmp_path / "o.npz", itinerary_offsets=[0, 2, 1], itinerary_objects=[0], object_bytes=[1]
    )
    assert refused(tmp_path / "o.npz").startswith("column ray_itinerary: offsets don't rise from 0")


def test_the_picture_must_hold_the_primary_rays(tmp_path: Path) -> None:
    flat = dict(itinerary_offsets=[0, 1, 2], itinerary_objects=[0, 0], object_bytes=[1])
    np.savez(tmp_path / "a.npz", picture=[2, 1], **flat)
    assert import_workload(tmp_path / "a.npz").picture == (2, 1)
    for wrong in ([1, 1], [2], [-1, -2], [2.0, 1.0]):
        np.savez(tmp_path / "a.npz", picture=np.array(wrong), **flat)
        with pytest.raises(WorkloadError, match="expected rows and columns of the 2 primary rays"):
            import_workload(tmp_path / "a.npz")


def test_names() -> None:
    assert is_workload("a.NPZ")
    assert not is_workload("a.glb")
    with pytest.raises(WorkloadError, match="expected a file"):
        export_workload(SMALL, "a.csv")


@pytest.mark.parametrize("suffix", SUFFIXES)
@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_file_is_a_workload_or_an_error(
    tmp_path: Path, suffix: str, data: st.DataObject
) -> None:
    path = write(tmp_path / f"a{suffix}", RAYS, OBJECTS)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 8))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(len(content) // 2, len(content)))])
    sound_or_refused(path)


NUMBERS = st.integers(-2, 6) | st.sampled_from([2**31, 2**63 - 1, -(2**63)])
CELLS = NUMBERS | st.floats() | st.text(max_size=3) | st.none() | st.booleans()


@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_columns_are_a_workload_or_an_error(tmp_path: Path, data: st.DataObject) -> None:
    rays, objects = dict(RAYS), dict(OBJECTS)
    extras = ["round", "home", "weight", "test_scale"]
    names_of_rays = [*rays, "hit", "distance", *extras]
    for table, names in ((rays, names_of_rays), (objects, [*objects, "test_ps", "results"])):
        for name in data.draw(st.sets(st.sampled_from(names), max_size=3)):
            cell = st.lists(NUMBERS, max_size=3) if name == "itinerary" else CELLS
            cells = data.draw(
                st.lists(cell, min_size=len(table["kind"]), max_size=len(table["kind"]))
            )
            try:
                table[name] = pa.array(cells)
            except (pa.ArrowException, OverflowError):
                table[name] = pa.array(list(map(str, cells)))
    sound_or_refused(write(tmp_path / "a.parquet", rays, objects))


def sound_or_refused(path: Path) -> None:
    try:
        workload = import_workload(path)
    except WorkloadError as error:
        assert "\n" not in str(error)
    else:
        check(workload, "")


FLAT = {"itinerary": [[0], [1, 2], [], [2]]}
"""All rays are primary."""


@pytest.mark.parametrize(
    "parent",
    [
        pa.nulls(4),
        pa.nulls(4, pa.int16()),
        pa.nulls(4, pa.float64()),
        pa.array([None, -1, None, -1]),
        pa.array([np.nan] * 4),
        pa.array([-1.0, None, np.nan, None]),
    ],
)
def test_whatever_says_that_there_is_no_parent(tmp_path: Path, parent: pa.Array) -> None:
    plain = import_workload(write(tmp_path / "plain.parquet", FLAT, OBJECTS))
    columns = FLAT | {"parent": parent, "hit": pa.nulls(4)}
    assert same(import_workload(write(tmp_path / "a.parquet", columns, OBJECTS)), plain)


def test_pandas_makes_floats_of_integers_with_nulls(tmp_path: Path) -> None:
    plain = import_workload(write(tmp_path / "plain.parquet", RAYS, OBJECTS))
    frame = pd.DataFrame(RAYS | {"parent": [None, 0, 3, 0, None]})
    assert frame["parent"].dtype == np.float64
    pd.DataFrame(OBJECTS).to_parquet(tmp_path / "a.objects.parquet")
    for index in (frame.index, [5, 3, 2, 8, 9], list("abcde")):  # a range is kept as metadata only
        frame.set_index(pd.Index(index)).to_parquet(tmp_path / "a.parquet")
        assert same(import_workload(tmp_path / "a.parquet"), plain)
    for wrong in (0.5, np.inf, 1e12):
        frame["parent"] = [None, 0, 3, wrong, None]
        frame.to_parquet(tmp_path / "a.parquet")
        with pytest.raises(WorkloadError, match=r"column parent, row 3: value .*: it holds double"):
            import_workload(tmp_path / "a.parquet")


@given(cuts=st.lists(st.integers(0, 5), max_size=4), seed=st.integers(0, 5))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=20)
def test_parts_in_a_folder_are_one_table(tmp_path: Path, cuts: list[int], seed: int) -> None:
    """Wherever a table is cut, also into parts of no rows or of primary rays alone."""
    whole = import_workload(write(tmp_path / "whole.parquet", RAYS, OBJECTS))
    rays = pa.table(RAYS | {"parent": pa.array([None, 0, 3, 0, None])})
    for name, table in (("cut.parquet", rays), ("cut.objects.parquet", pa.table(OBJECTS))):
        folder = tmp_path / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        (folder / "_SUCCESS").touch()
        (folder / ".part-0.parquet.crc").touch()
        ends = [0, *sorted(min(cut, len(table)) for cut in cuts), len(table)]
        for number, (low, high) in enumerate(pairwise(ends)):
            part = pa.table(table[low:high].to_pydict(), table.schema if high == low else None)
            parquet.write_table(part, folder / f"part-{number}.parquet")
    assert same(import_workload(tmp_path / "cut.parquet"), whole)


def test_parts_that_do_not_fit_together(tmp_path: Path) -> None:
    def refused() -> str:
        with pytest.raises(WorkloadError) as caught:
            import_workload(tmp_path / "a.parquet")
        return str(caught.value).removeprefix(f"{tmp_path}/")

    pd.DataFrame(OBJECTS).to_parquet(tmp_path / "a.objects.parquet")
    folder = tmp_path / "a.parquet"
    folder.mkdir()
    assert refused() == "a.parquet: expected files *.parquet in this folder"
    pd.DataFrame(FLAT).to_parquet(folder / "0.parquet")
    pd.DataFrame(FLAT | {"pixel": [0] * 4}).to_parquet(folder / "1.parquet")
    problem = "column pixel: only one of this file and 0.parquet has it"
    assert refused() == f"a.parquet/1.parquet: {problem}"
    pd.DataFrame({"itinerary": ["a"]}).to_parquet(folder / "1.parquet")
    assert refused().startswith("a.parquet: can't be read: ")


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(
    ("right", "wrong"),
    [("bytes", "byte"), ("parent", "Parent"), ("x", "X"), ("itinerary", "itineraries")],
)
def test_a_misspelt_column_is_named(tmp_path: Path, suffix: str, right: str, wrong: str) -> None:
    tables = [dict(RAYS), dict(OBJECTS)]
    path = write(tmp_path / f"a{suffix}", *tables)
    for table in tables:
        if right in table:
            table[wrong] = table.pop(right)
    if suffix == ".npz":
        with np.load(path) as file:
            arrays = dict(file)
        names = (f"ray_{right}", f"object_{right}", f"{right}_offsets")
        (name,) = (name for name in arrays if name in names)
        arrays[name.replace(right, wrong)] = arrays.pop(name)
        np.savez(path, **arrays)
        right, wrong = name, name.replace(right, wrong)
    else:
        path = write(path, *tables)
    with pytest.raises(WorkloadError) as caught:
        import_workload(path)
    problem = caught.value.problem.replace("'", "").replace("array ", "column ")
    assert problem == f"column {wrong}: it is unknown: did you mean {right}?"
