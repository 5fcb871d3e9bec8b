"""What tests leave in objects, in whole numbers."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from builders import random_case, with_other_rays, with_repeats, workload_of
from numpy.typing import NDArray

from simmpp.workload.tallies import leaving, table_of, tally_of, tally_of_tests
from simmpp.workload.workload import Workload

Array = NDArray[np.int64]


def two_rays(**said: object) -> Workload:
    """Tests against 0, 1 and 1 again, a hit; and against 0, another one."""
    workload = workload_of(2, [[0, 1, 1], [0]], object_bytes=[1, 1, 1])
    return replace(workload, **said)  # type: ignore[arg-type]


def test_a_ray_leaves_the_weight_of_its_root_in_what_it_hits_once() -> None:
    told = table_of(tally_of(two_rays(root_weights=np.array([1.5, 0.25]))))
    assert {name: column.tolist() for name, column in told.items()} == {
        "object": [0, 1, 2],
        "sum": [0.25, 1.5, 0],
        "sum_of_squares": [0.0625, 2.25, 0],
        "count": [1, 1, 0],
    }


def test_each_test_leaves_what_the_workload_says() -> None:
    units = np.array([0, 1, 3 << 31, 1 << 32])
    tally = tally_of(two_rays(test_deposits=units))
    assert tally.sums.tolist() == [1 << 32, (3 << 31) + 1, 0]
    assert tally.squares.tolist() == [1, 2, 0]
    assert tally.rests.tolist() == [0, 1 << 30, 0]  # a square of 2^-64 is below a unit
    assert tally.counts.tolist() == [1, 2, 0]


def test_squares_are_those_of_whole_numbers_rounded_down() -> None:
    rng = np.random.default_rng(3)
    units = rng.integers(0, 1 << rng.integers(1, 59, 200))
    workload = workload_of(200, [[0]] * 200, object_bytes=[1])
    for one in units.tolist():
        deposits = np.zeros(200, np.int64)
        deposits[0] = one
        tally = tally_of(replace(workload, test_deposits=deposits))
        square = int(Fraction(one) ** 2 / 2**32)
        assert (int(tally.squares[0]) << 32) + int(tally.rests[0]) == square


def test_great_weights_have_larger_units() -> None:
    weights = np.array([1e12, 3e12])
    told = table_of(tally_of(two_rays(root_weights=weights)))
    assert told["sum"].tolist() == [3e12, 1e12, 0]
    assert told["sum_of_squares"].tolist() == pytest.approx([9e24, 1e24, 0])


def test_what_tests_leave_does_not_depend_on_who_makes_them_when() -> None:
    for seed in range(60):
        rng = np.random.default_rng(seed)
        workload = with_other_rays(rng, with_repeats(rng, random_case(seed).workload))
        numbers = np.arange(workload.n_rays, dtype=np.int32)
        rays: NDArray[np.int32] = np.repeat(numbers, np.diff(workload.itinerary_offsets))
        # Any order in which each ray makes its own tests one after the other.
        order = np.argsort(rng.random(workload.n_rays)[rays], kind="stable")
        rays, objects = rays[order], workload.itinerary_objects[order]
        told, made = tally_of(workload), tally_of_tests(workload, rays, objects)
        for mine, others in zip(told, made, strict=True):
            np.testing.assert_array_equal(mine, others)
        fewer = tally_of_tests(workload, rays[:-1], objects[:-1])
        assert (fewer.sums <= told.sums).all()
        counted = told.counts[workload.object_results > 0] if len(workload.object_results) else 0
        assert leaving(workload).sum() == np.sum(counted)
