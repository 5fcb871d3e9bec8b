"""Owners, residents and pixels: counts, nesting, seeds, and draws that must never change."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from builders import random_case, workload_of
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.randomness import generator
from simmpp.placement.owners import owners
from simmpp.placement.pixels import pixel_pes
from simmpp.placement.place import place
from simmpp.placement.placement import Cells, Memory, PlacementRules, Transient
from simmpp.placement.residents import resident_count
from simmpp.workload.workload import Workload

OWNERS = ("bisection", "morton", "round_robin", "random")
RESIDENTS = ("random", "nearest", "hot", "used")
PIXELS = ("blocks", "rows", "tiles", "interleaved", "random")
PICTURES = st.tuples(st.integers(1, 12), st.integers(1, 12))


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
@given(picture=PICTURES, processors=st.integers(1, 30), seed=st.integers(0, 2))
def test_pixels_are_dealt_evenly(
    rule: str, picture: tuple[int, int], processors: int, seed: int
) -> None:
    dealt = pixel_pes(rule, picture, processors, seed)  # type: ignore[arg-type]
    counts = np.bincount(dealt, minlength=processors)
    assert len(dealt) == picture[0] * picture[1]
    assert len(counts) == processors
    if rule != "tiles":
        assert counts.max() - counts.min() <= (picture[1] if rule == "rows" else 1)


@given(picture=PICTURES, side=st.integers(1, 14), processors=st.integers(1, 30))
def test_cells_and_rows_are_counted_off_in_turn(
    picture: tuple[int, int], side: int, processors: int
) -> None:
    def dealt(rule: Any) -> list[int]:
        pes = pixel_pes(rule, picture, processors, 0)
        assert pes.dtype == np.int32
        return pes.tolist()

    assert dealt(Cells(side)) == counted_off(picture, (side, side), processors)
    assert dealt("rows") == counted_off(picture, (1, picture[1]), processors)
    assert dealt("interleaved") == dealt(Cells(1)) == counted_off(picture, (1, 1), processors)
    most = -(-len(set(cells_of(picture, (side, side)))) // processors) * side * side
    assert max(np.bincount(dealt(Cells(side)))) <= most


def counted_off(picture: tuple[int, int], cell: tuple[int, int], processors: int) -> list[int]:
    """PEs by going over the picture pixel by pixel: each cell that is met first gets the next."""
    pe_of: dict[tuple[int, int], int] = {}
    return [pe_of.setdefault(each, len(pe_of) % processors) for each in cells_of(picture, cell)]


def cells_of(picture: tuple[int, int], cell: tuple[int, int]) -> list[tuple[int, int]]:
    """Row and column of each pixel's cell."""
    return [(y // cell[0], x // cell[1]) for y in range(picture[0]) for x in range(picture[1])]


@given(
    down=st.integers(1, 4),
    across=st.integers(1, 4),
    side=st.integers(1, 4),
    processors=st.integers(1, 9),
)
def test_whole_cells_differ_by_one_between_pes(
    down: int, across: int, side: int, processors: int
) -> None:
    dealt = pixel_pes(Cells(side), (down * side, across * side), processors, 0)
    counts = np.bincount(dealt, minlength=processors)
    assert counts.max() - counts.min() in (0, side * side)


@pytest.mark.parametrize("residents", RESIDENTS)
@pytest.mark.parametrize("rule", ["blocks", "interleaved", "random", Cells(3), "rows"])
@given(case=st.integers(0, 200), processors=st.integers(1, 9))
def test_rays_below_one_another_are_placed_as_those_in_a_row_but_for_rows(
    rule: Any, residents: Any, case: int, processors: int
) -> None:
    listed = random_case(case).workload
    one_wide = replace(listed, picture=(listed.n_primaries, 1))
    in_a_row = replace(listed, picture=(1, listed.n_primaries))
    memory, rules = Memory(Fraction(1, 3), residents=residents), PlacementRules(pixels=rule)
    ours = place(one_wide, processors, memory, rules, 0)
    turns = PlacementRules(pixels="interleaved")
    theirs = place(in_a_row, processors, memory, turns if rule == "rows" else rules, 0)
    assert np.array_equal(ours.pixel_pes, theirs.pixel_pes)
    assert np.array_equal(ours.replica_objects, theirs.replica_objects)


def test_pixels_worked_by_hand() -> None:
    assert pixel_pes("blocks", (2, 4), 3, 0).tolist() == [0, 0, 1, 1, 1, 2, 2, 2]
    assert pixel_pes("interleaved", (1, 5), 2, 0).tolist() == [0, 1, 0, 1, 0]
    tiles = pixel_pes("tiles", (4, 4), 4, 0).reshape(4, 4)
    assert tiles.tolist() == [[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]]
    wide = pixel_pes("tiles", (2, 8), 4, 0).reshape(2, 8)
    assert wide.tolist() == [[0, 0, 1, 1, 2, 2, 3, 3]] * 2
    assert pixel_pes("rows", (5, 2), 3, 0).tolist() == [0, 0, 1, 1, 2, 2, 0, 0, 1, 1]
    # 3 cells of 2 x 2 side by side, the last one pixel wide, and the lower ones one pixel high
    cells = pixel_pes(Cells(2), (3, 5), 4, 0).reshape(3, 5)
    assert cells.tolist() == [[0, 0, 1, 1, 2], [0, 0, 1, 1, 2], [3, 3, 0, 0, 1]]
    assert pixel_pes(Cells(2**31 - 1), (2, 2), 3, 0).tolist() == [0, 0, 0, 0]


@pytest.mark.parametrize("transient", [0, 3, Fraction(0), Fraction(1, 3), Fraction(1), "x"])
@pytest.mark.parametrize("residents", RESIDENTS)
@given(case_seed=st.integers(0, 200), fraction=st.sampled_from([0, 1, 2, 5, 8]))
def test_what_is_kept_is_a_number_or_a_share_of_all_objects(
    residents: str, transient: Transient, case_seed: int, fraction: int
) -> None:
    workload = random_case(case_seed).workload
    x, n = Fraction(fraction, 8), workload.n_objects
    memory = Memory(x, residents=residents, transient=transient)  # type: ignore[arg-type]
    share = x if transient == "x" else transient
    wanted = share if isinstance(share, int) else math.floor(share * n + Fraction(1, 2))
    for processors in (1, 3):
        placed = place(workload, processors, memory, PlacementRules(), 0)
        assert placed.transient == wanted and type(placed.transient) is int


def test_as_many_are_kept_as_are_resident_in_the_mean_where_memory_is_in_bytes() -> None:
    # 5 objects of a byte: two PEs own 2 and 3, and hold 3 each of 3 bytes: 3 in the mean
    workload = workload_of(5, [[i] for i in range(5)], object_bytes=[1] * 5)

    def kept(room: int, processors: int) -> int:
        memory = Memory(bytes=room, transient="x")
        return place(workload, processors, memory, PlacementRules("round_robin"), 0).transient

    assert [kept(room, 2) for room in (0, 2, 3, 4, 5, 9)] == [3, 3, 3, 4, 5, 5]  # 2 1/2 is 3
    assert [kept(room, 4) for room in (0, 1, 2, 3)] == [1, 1, 2, 3]  # 5/4, 5/4, 2, 3
    assert kept(0, 1) == 5
    assert (
        place(workload, 2, Memory(bytes=0, transient=Fraction(1, 2)), PlacementRules(), 0).transient
        == 3
    )


def test_nothing_is_kept_of_an_empty_scene() -> None:
    nothing = workload_of(0, [[]])
    for memory in (
        Memory(transient="x"),
        Memory(transient=Fraction(1)),
        Memory(bytes=9, transient="x"),
    ):
        assert place(nothing, 2, memory, PlacementRules(), 0).transient == 0


def test_golden_draws() -> None:
    """These draws are part of every published row: a change of them changes all results."""
    assert generator(0, "residents", 3).permutation(8).tolist() == GOLDEN_RESIDENTS
    assert generator(1, "owners").permutation(8).tolist() == GOLDEN_OWNERS
    assert generator(0, "pixels").permutation(8).tolist() == GOLDEN_PIXELS


GOLDEN_RESIDENTS = [7, 3, 6, 4, 0, 1, 2, 5]
GOLDEN_OWNERS = [3, 4, 5, 1, 7, 2, 6, 0]
GOLDEN_PIXELS = [5, 2, 0, 3, 7, 6, 4, 1]
