"""Memory that ends, worked out by hand on the machine of ``by_hand``, and its known ways to a halt.

A ray has 10 bytes, a header 4, a request 8; object 0 (40 bytes) is PE 0's, object 1 (50) PE 1's.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from builders import Case
from by_hand import EAGER, OBJECT, RAY, activities_of, case_of
from implementations import IMPLEMENTATIONS, run

from simmpp.engine.capacity import needs_of, split
from simmpp.placement.rooms import LEAST, Capacity, Room

NOTHING = Room(0)


def within(case: Case, bytes_: Any = LEAST, **bounds: Any) -> Case:
    """The case on PEs with that capacity, all of it beside least shares for rays."""
    capacity = Capacity(bytes_, **({"buffers": NOTHING, "fetch": NOTHING} | bounds))
    return replace(case, placement=replace(case.placement, capacity=capacity))


def test_the_least_and_the_parts_of_two_pes() -> None:
    rays, children = [(0, [1]), (1, [0])], [(0, 1, [0]), (0, 1, [1])]
    case = within(case_of(RAY, rays, children))
    needs = needs_of(case.workload, case.machine, case.placement, case.policy)
    assert needs.resident.tolist() == [40, 50]
    assert needs.escape.tolist() == [50, 40]  # the largest that is not its own
    assert (needs.control, needs.tree, needs.receive) == (4 + 8, 2 * 10, 4 + 10)
    assert needs.least_bytes == 90 + 12 + 20 + 14
    wishes = Capacity(LEAST, buffers=Fraction(1, 2), fetch=Fraction(1, 4))
    parts = split(needs, wishes, needs.least_bytes + 100)  # 134 beside what is permanent
    assert (parts.receive[0], parts.fetch[0], parts.queue[0]) == (67, 0, 67)


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_one_ray_a_share_and_its_credit(implementation: str) -> None:
    """PE 0's two rays need object 1. The queue holds one: the second starts when it has left.

    0 to 1 the probe; ray 0 waits and is sent: packed at 25. Then ray 1 starts and waits: the share
    of PE 1 is full, so it is stuck, and asks at 26: packed at 38. PE 1 has ray 0 at 25 + 144 = 169:
    38 to unpack, at 207; half of the share is owed then, all of it: a load, packed at 222.
    """
    outcome = run(implementation, within(case_of(RAY, [(0, [1]), (0, [1])])))
    assert activities_of(outcome, 0)[:2] == [(0, "compute", 25, 0), (25, "compute", 38, 0)]
    assert activities_of(outcome, 1)[0] == (169, "receive rays", 222, 0)
    memory = outcome.memory
    assert (memory["escapes"], memory["credit_messages"]) == (1, 1)
    # PE 1 holds most: its object, and a ray with its header in the inbox.
    assert (memory["peak_resident"], memory["peak_receive"]) == (50, 14)
    assert memory["peak_ray_queue"] == 0
    # From the dispatch at 26 to the one after the credit, which is there at 222 + 134 + 29.
    assert memory["stalled_send_ps"] == 385 - 26
    assert outcome.tests == 2


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
@pytest.mark.parametrize("nb", [2, 3, 5])
def test_a_ring_full_of_rays_for_the_next_ends_by_escapes(implementation: str, nb: int) -> None:
    """Every PE holds one ray more than its neighbour has a share for, and nothing else."""
    rays = [(pe, [(pe + 1) % nb]) for pe in range(nb) for _ in range(2)]
    case = case_of(
        RAY, rays, owners=tuple(range(nb)), object_bytes=(50,) * nb, shape=(nb, 1, 1), quantum=1
    )
    outcome = run(implementation, within(case))
    assert outcome.tests == 2 * nb
    assert 1 <= outcome.memory["escapes"] <= nb
    stuck = run(implementation, within(case, escape="none"))
    assert stuck.memory["escapes"] == 0
    assert stuck.memory["infeasible"] in (0, 1)


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_requests_are_handled_whatever_rays_ride_with_them(implementation: str) -> None:
    """Two full PEs whose requests ride with rays that do not fit: parts are handled one by one."""
    policy = replace(EAGER, packing="all", min_load=3)
    rays = [(pe, [1 - pe, pe, 1 - pe]) for pe in (0, 1) for _ in range(6)]
    outcome = run(implementation, within(case_of(policy, rays)))
    assert outcome.tests == 36
    assert outcome.memory["infeasible"] == 0


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_a_dispatch_that_sends_escapes_as_well(implementation: str) -> None:
    """PE 0 sends one ray, and is left with one that has no credit: its next instant is its sleep.

    (Escapes only of dispatches that sent nothing are a deadlock.)
    """
    case = case_of(RAY, [(0, [1]), (0, [1]), (0, [1])])
    least = needs_of(case.workload, case.machine, within(case).placement, case.policy).least_bytes
    outcome = run(implementation, within(case, least + 20))
    assert outcome.tests == 3
    assert outcome.memory["escapes"] >= 1


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_an_object_without_room_comes_by_the_escape(implementation: str) -> None:
    """PE 0 may fetch 50 bytes at a time: the other object that rays wait for has to wait."""
    case = case_of(
        OBJECT,
        [(0, [1]), (0, [2])],
        owners=(0, 1, 1),
        object_bytes=(40, 50, 50),
    )
    least = needs_of(case.workload, case.machine, within(case).placement, case.policy).least_bytes
    outcome = run(implementation, within(case, least + 60, fetch=Room(50)))
    assert outcome.memory["peak_fetched"] == 50
    assert outcome.memory["stalled_ask_ps"] > 0
    assert outcome.memory["escapes"] == 1


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_kept_objects_leave_for_one_that_is_asked_for(implementation: str) -> None:
    case = case_of(
        OBJECT,
        [(0, [1, 2])],
        owners=(0, 1, 1),
        object_bytes=(40, 50, 50),
        transient=2,
    )
    least = needs_of(case.workload, case.machine, within(case).placement, case.policy).least_bytes
    outcome = run(implementation, within(case, least + 60, fetch=Room(50)))
    assert (outcome.memory["peak_fetched"], outcome.memory["stalled_ask_ps"]) == (50, 0)


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_without_credits_what_is_held_is_compared(implementation: str) -> None:
    """PE 0 starts three rays in one quantum: 30 bytes beside its object, 12 for a request."""
    case = case_of(RAY, [(0, [1]), (0, [1]), (0, [1])])
    outcome = run(implementation, within(case, 100, flow="none"))
    memory = outcome.memory
    # PE 1: its object (50) and the three rays in its inbox, with a header.
    assert (memory["peak_resident"], memory["peak_ray_queue"], memory["peak_receive"]) == (
        50,
        0,
        34,
    )
    assert (memory["exceeds_bytes"], memory["infeasible"]) == (0, 0)
    over = run(implementation, within(case, 70, flow="none")).memory
    assert (over["fits"], over["exceeds_bytes"]) == (0, 84 - 70)
