"""Owners, residents and pixels: counts, nesting, seeds, and draws that must never change."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from builders import random_case, workload_of
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.randomness import generator
from simmpp.placement.owners import owners
from simmpp.placement.pixels import pixel_pes
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.placement.residents import resident_count
from simmpp.workload.workload import Workload

OWNERS = ("bisection", "morton", "round_robin", "random")
RESIDENTS = ("random", "nearest", "hot")
PIXELS = ("blocks", "tiles", "interleaved", "random")


def a_workload(least_objects: int = 4) -> Workload:
    cases = map(random_case, range(1000))
    return next(c.workload for c in cases if c.workload.n_objects >= least_objects)


@pytest.mark.parametrize("rule", OWNERS)
@given(n_objects=st.integers(0, 60), processors=st.integers(1, 20), seed=st.integers(0, 3))
def test_every_object_has_one_owner_and_parts_are_even(
    rule: str, n_objects: int, processors: int, seed: int
) -> None:
    centroids = np.random.default_rng(seed).integers(0, 4, (n_objects, 3)) / 4.0
    found = owners(rule, centroids, processors, seed)  # type: ignore[arg-type]
    counts = np.bincount(found, minlength=processors)
    assert len(found) == n_objects
    assert len(counts) == processors
    assert counts.max() - counts.min() <= 1


def test_bisection_cuts_the_longest_axis_at_the_median() -> None:
    centroids = np.array([[x, y, 0.0] for x in (0.0, 1.0, 2.0, 3.0) for y in (0.0, 1.0)])
    assert owners("bisection", centroids, 2, 0).tolist() == [0, 0, 0, 0, 1, 1, 1, 1]
    # Each half is 1 wide and 1 high: a tie, cut along x.
    assert owners("bisection", centroids, 4, 0).tolist() == [0, 0, 1, 1, 2, 2, 3, 3]


def test_bisection_breaks_ties_by_id() -> None:
    assert owners("bisection", np.zeros((4, 3)), 2, 0).tolist() == [0, 0, 1, 1]


def test_morton_walks_the_z_curve() -> None:
    corners = np.array([[x, y, z] for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)])
    assert owners("morton", corners, 8, 0).tolist() == list(range(8))
    assert owners("morton", corners[::-1], 8, 0).tolist() == list(range(7, -1, -1))


@pytest.mark.parametrize("residents", RESIDENTS)
@given(case_seed=st.integers(0, 200), seed=st.integers(0, 3))
def test_residents_are_counted_nested_and_never_own(
    residents: str, case_seed: int, seed: int
) -> None:
    case = random_case(case_seed)
    workload, processors = case.workload, case.machine.processors
    smaller: list[list[int]] = [[] for _ in range(processors)]
    for fraction in (Fraction(0), Fraction(1, 3), Fraction(1, 2), Fraction(1)):
        memory = Memory(fraction=fraction, residents=residents)  # type: ignore[arg-type]
        placed = place(workload, processors, memory, PlacementRules(), seed)
        n_own = np.bincount(placed.owners, minlength=processors)
        for pe in range(processors):
            span = slice(*placed.replica_offsets[pe : pe + 2].tolist())
            held = placed.replica_objects[span].tolist()
            wanted = max(int(n_own[pe]), resident_count(fraction, workload.n_objects))
            assert n_own[pe] + len(held) == wanted
            assert len(set(held)) == len(held)
            assert not any(placed.owners[held] == pe)
            assert held[: len(smaller[pe])] == smaller[pe]
            smaller[pe] = held


def test_bytes_of_memory_are_not_exceeded() -> None:
    workload = a_workload()
    total = int(workload.object_bytes.sum())
    for room in (0, total // 3, total // 2, total):
        placed = place(workload, 2, Memory(bytes=room), PlacementRules(), 0)
        for pe in range(2):
            own = int(workload.object_bytes[placed.owners == pe].sum())
            span = slice(*placed.replica_offsets[pe : pe + 2].tolist())
            held = own + int(workload.object_bytes[placed.replica_objects[span]].sum())
            assert held <= max(room, own)
    assert placed.effective_fraction == 1.0


def test_hot_objects_are_those_of_every_fourth_row_and_column() -> None:
    one_each = replace(
        workload_of(64, [[i] for i in range(64)], object_bytes=[1] * 64), picture=(8, 8)
    )
    memory, rules = Memory(Fraction(5, 64), residents="hot"), PlacementRules(owners="round_robin")
    placed = place(one_each, 63, memory, rules, 0)
    assert placed.replica_objects[slice(*placed.replica_offsets[1:3])].tolist() == [0, 4, 32, 36]


def test_half_an_object_is_rounded_up() -> None:
    assert [resident_count(Fraction(x, 10), 5) for x in (0, 1, 2, 3, 10)] == [0, 1, 1, 2, 5]


@pytest.mark.parametrize("rule", PIXELS)
@given(
    rows=st.integers(1, 12),
    columns=st.integers(1, 12),
    processors=st.integers(1, 30),
    seed=st.integers(0, 2),
)
def test_pixels_are_dealt_evenly(
    rule: str, rows: int, columns: int, processors: int, seed: int
) -> None:
    found = pixel_pes(rule, (rows, columns), processors, seed)  # type: ignore[arg-type]
    counts = np.bincount(found, minlength=processors)
    assert len(found) == rows * columns
    assert len(counts) == processors
    if rule != "tiles":
        assert counts.max() - counts.min() <= 1


def test_pixels_worked_by_hand() -> None:
    assert pixel_pes("blocks", (2, 4), 3, 0).tolist() == [0, 0, 1, 1, 1, 2, 2, 2]
    assert pixel_pes("interleaved", (1, 5), 2, 0).tolist() == [0, 1, 0, 1, 0]
    tiles = pixel_pes("tiles", (4, 4), 4, 0).reshape(4, 4)
    assert tiles.tolist() == [[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]]
    wide = pixel_pes("tiles", (2, 8), 4, 0).reshape(2, 8)
    assert wide.tolist() == [[0, 0, 1, 1, 2, 2, 3, 3]] * 2


def test_golden_draws() -> None:
    """These draws are part of every published row: a change of them changes all results."""
    assert generator(0, "residents", 3).permutation(8).tolist() == GOLDEN_RESIDENTS
    assert generator(1, "owners").permutation(8).tolist() == GOLDEN_OWNERS
    assert generator(0, "pixels").permutation(8).tolist() == GOLDEN_PIXELS


GOLDEN_RESIDENTS = [7, 3, 6, 4, 0, 1, 2, 5]
GOLDEN_OWNERS = [3, 4, 5, 1, 7, 2, 6, 0]
GOLDEN_PIXELS = [5, 2, 0, 3, 7, 6, 4, 1]
