"""Barriers, windows, reductions and deposits, worked out by hand on the tiny machine of by_hand.

A stage of two PEs takes 10 + 20 + 100 ps, so a barrier 130. A ray with k tests at home takes
1 + 1000 k + 500.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders import Case
from by_hand import OBJECT, case_of
from implementations import IMPLEMENTATIONS, run

from simmpp.policy.parameters import CEILING, PolicyParameters
from simmpp.workload.workload import FORM_FACTOR

BARRIER = 130
FIRST, LAST = 1501, 2501
"""A test and a ray; two tests and a ray."""


def in_rounds(rounds: list[int], rays: list[tuple[int, list[int]]], **placed: Any) -> Case:
    case = case_of(OBJECT, rays)
    workload = replace(case.workload, root_rounds=np.array(rounds, np.int32))
    return replace(case, workload=workload, placement=replace(case.placement, **placed))


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_all_wait_for_the_last_ray_and_for_the_barrier(implementation: str) -> None:
    case = in_rounds([0, 0, 1], [(0, [0]), (1, [1, 1]), (0, [0])])
    outcome = run(implementation, case)
    assert outcome.round_ends == [LAST, LAST + BARRIER + FIRST]
    assert outcome.makespan_ps == LAST + BARRIER + FIRST
    assert outcome.compute_ps == [3000, 2500]
    assert outcome.communication_ps == [2, 1]  # probes
    assert outcome.waiting_ps == [4132 - 3002, 4132 - 2501]
    assert outcome.round_messages == 2
    assert outcome.bytes_sent == 2 * 4
    assert outcome.peak_rays == 1  # what is of a later round is no load


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_where_a_maximum_is_sought_each_pe_takes_part(implementation: str) -> None:
    case = in_rounds([0, 0, 1], [(0, [0]), (1, [1, 1]), (0, [0])])
    kinds = np.full(3, FORM_FACTOR, np.uint8)
    outcome = run(implementation, replace(case, workload=replace(case.workload, kinds=kinds)))
    assert outcome.makespan_ps == LAST + BARRIER + 130 + FIRST
    assert outcome.communication_ps == [2 + 130, 1 + 130]
    assert outcome.round_messages == 4


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
@pytest.mark.parametrize("window", [1, 2, 3])
def test_rounds_of_a_window_are_there_together(implementation: str, window: int) -> None:
    rays = [(0, [0]), (1, [1, 1, 1]), (0, [0])]
    outcome = run(implementation, in_rounds([0, 1, 2], rays, window=window))
    long, second = 3501, FIRST + BARRIER
    third = second + long + BARRIER
    assert (
        outcome.round_ends
        == {
            1: [FIRST, second + long, third + FIRST],
            2: [FIRST, long, second + FIRST],  # when round 0 is over round 2 begins
            3: [FIRST, long, FIRST + 1500],  # one go
        }[window]
    )
    assert outcome.makespan_ps == max(outcome.round_ends)
    assert outcome.round_messages == 2 * (3 - window)


def with_results(policy: PolicyParameters, tallies: str) -> Case:
    """A ray on PE 0 that hits PE 1's object, in 16 bytes of results."""
    case = case_of(policy, [(0, [1])])
    workload = replace(case.workload, object_results=np.array([0, 16]))
    placement = replace(case.placement, tallies=tallies)  # type: ignore[arg-type]
    return replace(case, workload=workload, placement=placement)


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_copies_of_tallies_are_added_up_at_the_end(implementation: str) -> None:
    outcome = run(implementation, with_results(PolicyParameters(CEILING), "reduce"))
    assert outcome.reduction_ps == 130 + 16  # 1 byte per ps
    assert outcome.makespan_ps == FIRST + 146
    assert outcome.communication_ps == [1 + 146, 146]
    assert outcome.tally_messages == 2
    assert outcome.bytes_sent == 2 * (16 + 4)


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_a_run_ends_with_its_last_deposit(implementation: str) -> None:
    outcome = run(implementation, with_results(PolicyParameters(CEILING), "send"))
    departs = FIRST + 10 + 4 + 16
    arrives = departs + 130 + 16 + 4
    assert outcome.makespan_ps == arrives + 20 + 8 + 16
    assert outcome.communication_ps == [1 + 30, 44]
    assert outcome.tally_messages == 1
    assert outcome.bytes_sent == 16 + 4
    nothing = run(implementation, with_results(PolicyParameters(CEILING), "none"))
    assert (nothing.makespan_ps, nothing.tally_messages) == (FIRST, 0)


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_a_round_waits_for_its_deposits(implementation: str) -> None:
    case = case_of(PolicyParameters(CEILING), [(0, [1]), (0, [0])])
    said = {"object_results": np.array([0, 16]), "root_rounds": np.array([0, 1], np.int32)}
    placement = replace(case.placement, tallies="send")
    outcome = run(
        implementation,
        replace(case, workload=replace(case.workload, **said), placement=placement),
    )
    received = FIRST + 30 + 150 + 44
    assert outcome.round_ends == [received, received + BARRIER + FIRST]
