"""What limits a run: parts worked out by hand on the tiny machine of ``by_hand``."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import pytest
from builders import Case
from by_hand import MACHINE, OBJECT, RAY, case_of
from hypothesis import given
from hypothesis import strategies as st

from simmpp.engine.simulate import simulate
from simmpp.run.limits import (
    BANDWIDTH,
    COMMUNICATION,
    COMPUTE,
    COPYING,
    HOT,
    IMBALANCE,
    KINDS,
    LATENCY,
    LAUNCHES,
    STARTUPS,
    WAITING,
    Limits,
    MessageCosts,
    limits_of,
    limits_of_run,
    together,
)

COSTS = MessageCosts.of(asdict(MACHINE))


def limits_in(case: Case) -> tuple[Limits, Any]:
    result = simulate(case.workload, case.machine, case.placement, case.policy, engine="simpy")
    return limits_of_run(result, case.machine), result


def test_costs_of_messages() -> None:
    assert MessageCosts((10 + 20,) * 4, (2 + 6, 3 + 7, 4 + 8, 5 + 9), 100 + 30, 10**12) == COSTS


def test_an_object_is_fetched() -> None:
    # test_hand_worked: PE 0 computes 2500, communicates 91; PE 1 communicates 89; ends at 3006
    limits, result = limits_in(case_of(OBJECT, [(0, [0, 1])]))
    assert result.makespan_ps == 3006
    assert limits.parts_ps == {
        COMPUTE: 2500,
        STARTUPS: (10 + 2 + 20 + 6) + (10 + 3 + 20 + 7),
        COPYING: 50 + 50 + 2 * 1,  # packed, unpacked, two probes
        HOT: (2500 + 91) - 89,  # twice the distance from the mean
        IMBALANCE: 0,
        LATENCY: 661,  # of 2 x (3006 - 2591): flights are 2 x 130 of latency and a hop,
        BANDWIDTH: 169,  # and 12 + 54 bytes
    }
    assert sum(limits.parts_ps.values()) == 2 * 3006
    assert str(limits) == (
        "limited most by one hot PE, 42 % of the makespan (compute is 42 %); what would help "
        "first: deal pixels otherwise (placement.pixels)"
    )


def test_launches_are_told_from_tests() -> None:
    # test_pace_by_hand: two goes at computing, each of one test in place of four
    case = case_of(OBJECT, [(0, [0, 1])], compute_startup_ps=100, least_tests=4)
    limits, result = limits_in(case)
    assert (limits.parts_ps[COMPUTE], limits.parts_ps[LAUNCHES]) == (2500, 2 * 100 + 2 * 3000)
    assert sum(limits.parts_ps.values()) == 2 * result.makespan_ps
    assert "machine.quantum" in limits.help[LAUNCHES]


def test_a_ray_goes_to_and_fro() -> None:
    # test_hand_worked: computes 1500 and 3000, communicates 64 and 63; ends at 4915
    limits, result = limits_in(case_of(RAY, [(0, [1])], [(0, 1, [0]), (0, 3, [1])]))
    assert result.makespan_ps == 4915
    assert limits.parts_ps == {
        COMPUTE: 4500,
        STARTUPS: 2 * (10 + 4 + 20 + 8),
        COPYING: 2 * (10 + 10) + 3,
        HOT: (3000 + 63) - (1500 + 64),
        IMBALANCE: 0,
        LATENCY: 3343,  # of 2 x (4915 - 3063) = 3704: 2 x 130 of latency and a hop, 2 x 14 bytes
        BANDWIDTH: 361,
    }


def numbers(**cells: int) -> dict[str, int]:
    names = ("makespan_ps", "messages", "bytes_sent", "rays_sent", "compute_ps", "waiting_ps")
    kinds = (f"{kind}_messages" for kind in KINDS)
    return {**dict.fromkeys((*names, "communication_ps", *kinds), 0), **cells}


def test_one_hot_pe_is_told_from_imbalance() -> None:
    """Busy for 90, 50, 20 and 0 of 100 ps: the mean is 40."""
    found = limits_of(
        numbers(makespan_ps=100, compute_ps=160, waiting_ps=240), 4, COSTS, [90, 50, 20, 0], [0] * 4
    )
    expected = {HOT: 4 * (90 - 50), IMBALANCE: 4 * (50 - 40), LATENCY: 4 * (100 - 90)}
    assert {part: found.parts_ps[part] for part in expected} == expected
    assert found.first == HOT
    assert found.help[HOT] == "deal pixels otherwise (placement.pixels)"


def test_rows_alone_tell_no_kinds_of_waiting() -> None:
    row = numbers(makespan_ps=100, compute_ps=50, communication_ps=50, waiting_ps=100, messages=1)
    row["request_messages"] = 1
    assert limits_of(row, 2, COSTS).parts_ps == {
        COMPUTE: 50,
        STARTUPS: 38,
        COPYING: 12,
        WAITING: 100,
    }
    assert limits_of(row, 2).parts_ps == {COMPUTE: 50, COMMUNICATION: 50, WAITING: 100}
    alone = limits_of(row | {"messages": 0}, 2)  # nobody waits for a message
    assert alone.parts_ps[IMBALANCE] == 100
    both = together([alone, limits_of(row, 2)]).parts_ps
    assert both == {COMPUTE: 100, COMMUNICATION: 100, IMBALANCE: 100, WAITING: 100}


def test_near_the_bound_nothing_but_compute_is_left() -> None:
    of = [numbers(makespan_ps=10, compute_ps=n, waiting_ps=20 - n) for n in (19, 17)]
    near, far = (limits_of(each, 2) for each in of)
    assert (near.first, far.first) == (COMPUTE, IMBALANCE)
    assert together([near, far]).parts_ps == {COMPUTE: 36, COMMUNICATION: 0, IMBALANCE: 4}
    assert limits_of(numbers(), 2).first == COMPUTE  # nothing at all


@pytest.mark.parametrize("kind", ["request", "ray"])
def test_help_is_of_the_messages_that_are_most(kind: str) -> None:
    row = numbers(makespan_ps=100, communication_ps=200, messages=5) | {f"{kind}_messages": 5}
    assert ("batches" in limits_of(row, 2, COSTS).help[STARTUPS]) == (kind == "ray")


PS = st.integers(0, 10**6)


@given(
    st.lists(st.tuples(PS, PS), min_size=1, max_size=6),
    PS,
    st.lists(st.integers(0, 99), min_size=4, max_size=4),
    PS,
)
def test_parts_add_up_to_the_makespan_of_all(
    accounts: list[tuple[int, int]], idle_ps: int, kinds: list[int], sent_bytes: int
) -> None:
    compute, communication = (list(of) for of in zip(*accounts, strict=True))
    nb, makespan_ps = len(accounts), max(map(sum, accounts)) + idle_ps
    row = numbers(
        makespan_ps=makespan_ps,
        messages=sum(kinds),
        bytes_sent=sent_bytes,
        compute_ps=sum(compute),
        communication_ps=sum(communication),
        waiting_ps=nb * makespan_ps - sum(compute) - sum(communication),
    ) | {
        f"{k}_messages": n for k, n in zip(("request", "object", "ray", "load"), kinds, strict=True)
    }
    for costs, of_pes in ((COSTS, (compute, communication)), (COSTS, ()), (None, ())):
        parts = limits_of(row, nb, costs, *of_pes).parts_ps
        assert sum(parts.values()) == nb * makespan_ps
        assert min(parts.values()) >= 0
