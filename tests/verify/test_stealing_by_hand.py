"""Stealing of pixels, worked out by hand (costs in ``by_hand``).

A question has no payload: 10 + 2 ps to send, 130 + 4 = 134 in between, 20 + 6 to receive. An answer
has 16 bytes: 12, 150 and 26 ps. Each pixel takes 1000 + 500 ps, a go at computing 1 ps more.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from builders import Case
from by_hand import MACHINE, case_of
from implementations import IMPLEMENTATIONS, run
from oracles.ledger import Outcome

from simmpp.placement.rooms import LEAST, Capacity
from simmpp.policy.parameters import PolicyParameters

pytestmark = pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
STEALS = PolicyParameters("replicated", steal="half")
QUESTION, ANSWER = 0, 16


def case(pixels: list[int], quantum: int, policy: PolicyParameters = STEALS) -> Case:
    """A PE with so many pixels each, on a ring; whatever these need is there."""
    rays = [(pe, [0]) for pe, n in enumerate(pixels) for _ in range(n)]
    by_hand = case_of(policy, rays)
    machine = replace(MACHINE, shape=(len(pixels), 1, 1), quantum=quantum)
    placement = replace(by_hand.placement, processors=len(pixels))
    offsets = np.zeros(len(pixels) + 1, np.int64)
    placement = replace(placement, replica_offsets=offsets)
    return replace(by_hand, machine=machine, placement=placement)


def talks(outcome: Outcome) -> list[tuple[int, int, int, int]]:
    """When which question or answer arrived: (ps, from, to, payload)."""
    arrived = [(time, s, d, n) for time, d, s, _, kind, n in outcome.arrivals if kind == "steal"]
    return sorted(arrived)


def test_half_of_what_is_left_goes_to_who_has_nothing(implementation: str) -> None:
    # PE 1 asks at 0. PE 0 makes two tests, until 3001, and has four pixels left when it has read
    # that at 3027: two go at 3039, are there at 3189 and read at 3215. Both compute two then: PE 0
    # until 3039 + 3001 = 6040, when it asks in its turn (12 + 134), PE 1 until 3215 + 3001.
    outcome = run(implementation, case([6, 0], quantum=2))
    expected = [(146, 1, 0, QUESTION), (3189, 0, 1, ANSWER), (6186, 0, 1, QUESTION)]
    assert talks(outcome) == expected
    assert outcome.makespan_ps == 6216
    assert [ray for ray, _ in outcome.tested] == [0, 1, 2, 3, 4, 5]
    assert outcome.communication_ps == [1 + 26 + 12 + 1 + 12, 12 + 26 + 1]
    assert outcome.steal_messages == 3
    assert outcome.bytes_sent == 3 * 4 + 16


def test_the_last_pixel_stays_and_a_refusal_wakes_nobody(implementation: str) -> None:
    # After a quantum of four PE 0 has one pixel left, which it keeps: 6001 + 26 + 12 + 1501.
    outcome = run(implementation, case([5, 0], quantum=4))
    assert talks(outcome) == [(146, 1, 0, QUESTION), (6189, 0, 1, ANSWER)]
    assert outcome.makespan_ps == 7540
    assert outcome.communication_ps == [1 + 26 + 12 + 1, 12 + 26]


def test_without_it_nobody_helps(implementation: str) -> None:
    outcome = run(implementation, case([6, 0], 2, PolicyParameters("replicated")))
    assert outcome.makespan_ps == 3 * 3001
    assert talks(outcome) == []


def test_who_is_refused_asks_the_next_by_the_loads_that_it_knows(implementation: str) -> None:
    # Nobody was heard yet, so PE 2 asks in ring order: PE 0 is done with its only pixel at 1501
    # when it reads that, refuses at 1539, has heard a load of 0, and asks PE 1, of whom 7 / 3 are
    # known; so does PE 2, at 1727. PE 1 has four left at 3001: two go at 3039, and of the others
    # one at 3077.
    outcome = run(implementation, case([1, 6, 0], quantum=2))
    assert talks(outcome)[:6] == [
        (146, 2, 0, QUESTION),
        (1685, 0, 1, QUESTION),
        (1689, 0, 2, ANSWER),
        (1861, 2, 1, QUESTION),
        (3189, 1, 0, ANSWER),
        (3227, 1, 2, ANSWER),
    ]
    # With exact loads it asks PE 1 at once.
    exact = replace(STEALS, load_info="exact")
    told = talks(run(implementation, case([1, 6, 0], 2, exact)))
    assert told[0][1:] == (2, 1, QUESTION)


def test_a_capacity_that_is_just_enough_changes_nothing_here(implementation: str) -> None:
    # A pixel has no children: a queue of one ray is room for each as its turn comes.
    unbounded = case([6, 0], quantum=2)
    placement = replace(unbounded.placement, capacity=Capacity(LEAST))
    bounded = run(implementation, replace(unbounded, placement=placement))
    assert talks(bounded) == talks(run(implementation, unbounded))
    assert bounded.makespan_ps == 6216
    assert bounded.memory["peak_ray_queue"] == MACHINE.ray_bytes
