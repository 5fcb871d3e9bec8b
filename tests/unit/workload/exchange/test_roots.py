"""Rounds, homes, weights, scaled tests and results: what other rays than a picture's have."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from builders import random_case, with_other_rays, workload_of
from pyarrow import parquet

from simmpp.common.errors import WorkloadError
from simmpp.workload.check import check
from simmpp.workload.exchange.exchange import export_workload, import_workload
from simmpp.workload.workload import (
    ARRAYS,
    DIFFUSE,
    FORM_FACTOR,
    OPTIONAL,
    PARTICLE,
    SHADOW,
    Workload,
)

SUFFIXES = (".parquet", ".npz")
CASES = 20


def assert_same(one: Workload, other: Workload) -> None:
    assert (one.picture, one.samples) == (other.picture, other.samples)
    for name in ARRAYS:
        mine, others = getattr(one, name), getattr(other, name)
        np.testing.assert_array_equal(mine, others, err_msg=name, strict=True)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_read(tmp_path: Path, suffix: str) -> None:
    path, seen = tmp_path / f"a{suffix}", set()
    for seed in range(CASES):
        workload = random_case(seed).workload
        spawners = np.diff(workload.child_offsets) > 0
        if workload.n_primaries == 0 or (spawners & (workload.hits < 0)).any():
            continue
        told = with_other_rays(np.random.default_rng(seed), workload)
        check(told, "")
        export_workload(told, path)
        assert_same(import_workload(path), told)
        seen |= {name for name in OPTIONAL if len(getattr(told, name))}
    assert seen == set(OPTIONAL) - {"object_test_ps", "round_residuals"}


def test_only_what_is_used_is_written(tmp_path: Path) -> None:
    workload = workload_of(1, [[0]], object_bytes=[1])
    plain = {"itinerary", "parent", "kind", "pixel", "hit", "distance"}
    export_workload(workload, tmp_path / "a.parquet")
    assert set(parquet.read_table(tmp_path / "a.parquet").column_names) == plain
    export_workload(
        dataclasses.replace(workload, root_homes=np.zeros(1, np.int32)), tmp_path / "a.parquet"
    )
    assert set(parquet.read_table(tmp_path / "a.parquet").column_names) == plain | {"home"}


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_several_primary_rays_of_a_pixel(tmp_path: Path, suffix: str) -> None:
    workload = dataclasses.replace(
        workload_of(6, [[0]] * 6, object_bytes=[1]), picture=(1, 2), samples=3
    )
    export_workload(workload, tmp_path / f"a{suffix}")
    again = import_workload(tmp_path / f"a{suffix}")
    assert_same(again, workload)
    assert again.n_primaries == 6


# A particle that comes back to cell 0, and splits; its home is cell 1.
PARTICLES: dict[str, Any] = {
    "itinerary": [[0, 1, 0], [0, 0], [1]],
    "parent": [-1, 0, 0],
    "kind": ["particle", "particle", "diffuse"],
    "round": [0, -1, 0],
    "home": pa.array([1, None, None]),
    "weight": [0.5, np.nan, 1.0],
    "test_scale": [2, 0, 16],
}
CELLS: dict[str, Any] = {"bytes": [8, 9], "results": [80, 0]}


def read(folder: Path, rays: dict[str, Any], objects: dict[str, Any]) -> Workload:
    parquet.write_table(pa.table(rays), folder / "a.parquet")
    parquet.write_table(pa.table(objects), folder / "a.objects.parquet")
    return import_workload(folder / "a.parquet")


def test_particles(tmp_path: Path) -> None:
    workload = read(tmp_path, PARTICLES, CELLS)
    assert workload.kinds.tolist() == [PARTICLE, PARTICLE, DIFFUSE]
    assert workload.itinerary_objects.tolist() == [0, 1, 0, 0, 0, 1]
    assert workload.root_rounds.tolist() == []
    assert workload.root_homes.tolist() == [1]
    assert workload.root_weights.tolist() == [0.5]
    assert workload.ray_test_scales.tolist() == [2, 0, 16]
    assert workload.object_results.tolist() == [80, 0]


def test_shadow_rays_are_the_last_siblings(tmp_path: Path) -> None:
    rays = {"itinerary": [[0]] * 3, "parent": [-1, 0, 0], "kind": ["primary", "shadow", "diffuse"]}
    assert read(tmp_path, rays, {"bytes": [1]}).kinds.tolist() == [0, DIFFUSE, SHADOW]


MISTAKES: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"kind": ["particle", "particle", "form_factor"]}, {},
     "column kind, row 2: a form_factor ray has parent 0"),
    ({"kind": ["diffuse", "particle", "particle"]}, {}, "column kind, row 0: a diffuse ray has no"),
    ({"kind": ["form_factor", "particle", "particle"]}, {},
     "column parent, row 1: value 0: expected no form_factor ray, which spawns nothing"),
    ({"kind": ["particle", "reflected", "diffuse"]}, {},
     "column itinerary, row 1: object 0 occurs twice: expected each once"),
    ({"round": [1, -1, 1]}, {}, "column round, row 0: value 1: no root is of round 0"),
    ({"round": [-1, -1, -1]}, {}, "column round, row 0: value -1: expected a round from 0"),
    ({"round": [0, 1, 0]}, {}, "column round, row 1: value 1: its root has another"),
    ({"home": [2, -1, -1]}, {}, "column home, row 0: value 2: expected -1 or a row of the 2"),
    ({"home": [1, 0, -1]}, {}, "column home, row 1: value 0: its root has another"),
    ({"weight": [-0.5, 1.0, 1.0]}, {}, "column weight, row 0: value -0.5: expected a weight"),
    ({"weight": [np.nan, 1.0, 1.0]}, {}, "column weight, row 0: value nan: expected a finite"),
    ({"test_scale": [0, 17, 0]}, {}, "column test_scale, row 1: value 17: expected an integer"),
    ({}, {"results": [0, -1]}, "column results, row 1: value -1: expected a size from 0"),
    ({"rounds": [0, 0, 0]}, {}, "column rounds: it is unknown: did you mean round?"),
]  # fmt: skip


@pytest.mark.parametrize(("rays", "objects", "line"), MISTAKES)
def test_mistakes(tmp_path: Path, rays: dict[str, Any], objects: dict[str, Any], line: str) -> None:
    with pytest.raises(WorkloadError) as caught:
        read(tmp_path, PARTICLES | rays, CELLS | objects)
    assert caught.value.problem.startswith(line)


def test_rounds_do_not_leave_one_out(tmp_path: Path) -> None:
    rays = {"itinerary": [[0]] * 3, "round": [0, 3, 1]}
    with pytest.raises(WorkloadError, match="row 1: value 3: no root is of round 2"):
        read(tmp_path, rays, {"bytes": [1]})
    workload = read(tmp_path, rays | {"round": [2, 0, 1]}, {"bytes": [1]})
    assert workload.n_rounds == 3
    assert workload.root_rounds.tolist() == [2, 0, 1]


@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("root_rounds", np.array([1], np.int32)),
        ("root_homes", np.array([2], np.int32)),
        ("root_weights", np.array([np.inf])),
        ("ray_test_scales", np.array([17, 0, 0], np.uint8)),
        ("object_results", np.array([0, -1])),
    ],
)
def test_a_workload_that_contradicts_itself(
    tmp_path: Path, name: str, array: np.ndarray[Any, Any]
) -> None:
    workload = dataclasses.replace(read(tmp_path, PARTICLES, CELLS), **{name: array})
    with pytest.raises(WorkloadError):
        check(workload, "a")
    assert FORM_FACTOR > SHADOW


@pytest.mark.parametrize(
    ("deposits", "problem"),
    [
        ([[1.5, 2], [0.25]], None),
        ([[1.5], [0.25]], "column deposit, row 0: expected a number for each object"),
        ([[1.5], [0.25, 2]], "column deposit, row 0: expected a number for each object"),
        ([[1, 2], [-1]], "column deposit, row 1: value -1: expected a number from 0 to"),
        ([[1, 2], [None]], r"column deposit, row 1: a number is missing \(null\)"),
        ([1, 2], "column deposit: it holds int64, expected lists of numbers"),
    ],
)
def test_each_test_may_say_what_it_deposits(
    tmp_path: Path, deposits: list[object], problem: str | None
) -> None:
    path = tmp_path / "a.parquet"
    rays = {"itinerary": [[1, 0], [1]], "deposit": deposits, "pixel": [1, 0]}
    parquet.write_table(pa.table(rays), path)
    parquet.write_table(pa.table({"bytes": [1, 1]}), tmp_path / "a.objects.parquet")
    if problem is None:
        assert import_workload(path).test_deposits.tolist() == [1 << 30, 3 << 31, 2 << 32]
    else:
        with pytest.raises(WorkloadError, match=problem):
            import_workload(path)
