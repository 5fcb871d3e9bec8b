"""Memory that ends: engines equal the oracle, which counts what is held from sets at every event.

The oracle asserts what must hold at every instant: what is used is within the capacity, credit that
is unused, under way and owed fills the share of each pair, and no ray is lost.
"""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from typing import Literal

import pytest
from builders import Case, random_case, some_stealing, with_capacity, with_policy
from implementations import IMPLEMENTATIONS, run

from simmpp.engine.simulate import ENGINES
from simmpp.placement.rooms import LEAST, Capacity

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "40"))
FIRST = int(os.environ.get("SIMMPP_TEST_FIRST_SEED", "0"))
BEYOND = 1 << 50
"""A capacity that nothing fills."""
ORDERS: tuple[Literal["depth-first"], Literal["breadth-first"]] = ("depth-first", "breadth-first")


@pytest.mark.parametrize("engine", ENGINES)
def test_every_integer_is_the_oracles(engine: str) -> None:
    for seed in range(FIRST, FIRST + CASES):
        case = with_capacity(some_stealing(random_case(seed), seed), seed)
        expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
        for name in expected:
            said = f"seed {seed}: {name} under {case.policy}, {case.placement.capacity}"
            assert got[name] == expected[name], said


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
@pytest.mark.parametrize("order", ORDERS)
def test_a_capacity_that_nothing_fills_changes_nothing(implementation: str, order: str) -> None:
    for seed in range(CASES // 4):
        drawn = some_stealing(random_case(seed), seed)
        case = with_policy(replace(drawn, ready_order=order), merge_requests=True)
        without = asdict(run(implementation, case))
        for flow in ("credits", "none"):
            bounds = Capacity(BEYOND, flow)  # type: ignore[arg-type]
            within = asdict(run(implementation, bounded(case, bounds)))
            for name in without.keys() - {"memory", "peak_bytes"}:
                assert within[name] == without[name], f"seed {seed}, {flow}: {name}"


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_the_least_capacity_is_enough(implementation: str) -> None:
    for seed in range(CASES // 4):
        case = with_capacity(random_case(seed), seed, bytes=LEAST, flow="credits")
        outcome = run(implementation, case)
        assert outcome.rays == case.workload.n_rays, f"seed {seed}"
        assert outcome.tests == case.workload.n_tests, f"seed {seed}"
        assert (outcome.memory["fits"], outcome.memory["infeasible"]) == (1, 0), f"seed {seed}"


@pytest.mark.parametrize("implementation", IMPLEMENTATIONS)
def test_without_an_escape_a_run_ends_or_says_that_it_can_not(implementation: str) -> None:
    ends = set()
    for seed in range(CASES):
        case = with_capacity(random_case(seed), seed, escape="none", bytes=LEAST, flow="credits")
        outcome = run(implementation, case)
        is_done = outcome.rays == case.workload.n_rays
        assert outcome.memory["infeasible"] == (not is_done), f"seed {seed}"
        assert outcome.memory["escapes"] == 0
        ends.add(is_done)
    assert ends == {True, False}


def bounded(case: Case, bounds: Capacity) -> Case:
    """The case with that capacity."""
    return replace(case, placement=replace(case.placement, capacity=bounds))
