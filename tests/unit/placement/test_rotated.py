"""Rotated residents: each placement like any other, all of them together fair to every object."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from builders import random_case
from hypothesis import given
from hypothesis import strategies as st

from simmpp.model.synthetic import synthetic
from simmpp.placement.place import place, rotated
from simmpp.placement.placement import Memory, Placement, PlacementRules

RULES = PlacementRules()
fractions = st.lists(st.fractions(0, 1, max_denominator=20), min_size=1, max_size=6)


def replicas_of(placement: Placement, pe: int) -> list[int]:
    span = slice(*placement.replica_offsets[pe : pe + 2].tolist())
    return placement.replica_objects[span].tolist()


@given(case_seed=st.integers(0, 200), xs=fractions, seed=st.integers(0, 3))
def test_each_placement_has_what_place_gives_but_for_the_draw(
    case_seed: int, xs: list[Fraction], seed: int
) -> None:
    case = random_case(case_seed)
    workload, nb = case.workload, case.machine.processors
    for x, placement in zip(xs, rotated(workload, nb, xs, RULES, seed), strict=True):
        other = place(workload, nb, Memory(fraction=x), RULES, seed)
        assert placement.owners.tolist() == other.owners.tolist()
        assert placement.pixel_pes.tolist() == other.pixel_pes.tolist()
        assert placement.replica_offsets.tolist() == other.replica_offsets.tolist()
        for pe in range(nb):
            held = replicas_of(placement, pe)
            assert len(set(held)) == len(held)
            assert not any(placement.owners[held] == pe)


@given(xs=fractions, seed=st.integers(0, 3))
def test_objects_are_held_equally_often_along_the_sweep(xs: list[Fraction], seed: int) -> None:
    workload = synthetic(4, 2, 23)
    placements = rotated(workload, 3, xs, RULES, seed)
    for pe in range(3):
        held = [object_id for p in placements for object_id in replicas_of(p, pe)]
        times = np.bincount(held, minlength=23)[placements[0].owners != pe]
        assert times.max() - times.min() <= 1


def test_every_object_is_as_likely_at_every_fraction() -> None:
    workload, xs, n_seeds = synthetic(4, 2, 12), [Fraction(1, 2), Fraction(2, 3)], 600
    counts = np.zeros((2, 12))
    for seed in range(n_seeds):
        for number, placement in enumerate(rotated(workload, 2, xs, RULES, seed)):
            counts[number, replicas_of(placement, 0)] += 1
    others = rotated(workload, 2, xs, RULES, 0)[0].owners != 0
    for number, wanted in enumerate((0, 2)):  # of 6 others, besides 6 own objects
        expected = n_seeds * wanted / 6
        assert counts[number, ~others].sum() == 0
        assert np.abs(counts[number, others] - expected).max() <= 4 * np.sqrt(expected)


def test_draws_never_change() -> None:
    placements = rotated(synthetic(4, 2, 12), 3, [Fraction(1, 2), Fraction(3, 4)], RULES, 7)
    assert [replicas_of(p, 1) for p in placements] == [[1, 9], [8, 11, 3, 2, 0]]
