"""Machines at the edges: costs 10^12 apart or none, a clock nearly full, odd and long tori."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from builders import Case, placement_of, random_case, workload_of
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from implementations import IMPLEMENTATIONS, run
from oracles.ledger import Outcome

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.engine.simulate import ENGINES
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.machine import UNLIMITED, CopyCost, Machine, TestCost
from simmpp.machine.torus import hops
from simmpp.machine.uneven import NOBODY
from simmpp.run.profit import profits

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "25"))
FREE = CopyCost(0, UNLIMITED)
TIMES = (
    "send_startup_ps",
    "receive_startup_ps",
    "probe_ps",
    "latency_ps",
    "hop_latency_ps",
    "ray_ps",
)
seeds = st.integers(0, 2**32 - 1)


def priced(machine: Machine, times: tuple[int, ...], test_ps: int, copy_ps: int) -> Machine:
    """Costs of these times, in the order of TIMES; bytes cost nothing."""
    copies, named = (CopyCost(copy_ps),) * 4, dict(zip(TIMES, times, strict=True))
    of_levels = {"latency_ps": named["latency_ps"], "gap_ps": named["probe_ps"], "bytes_per_s": 0}
    of_levels |= {name: named[name] for name in TIMES[:2]}
    return replace(
        machine,
        **named,
        port_gap_ps=named["probe_ps"],
        compute_startup_ps=named["probe_ps"],
        least_tests=0,
        speed=(),
        noise="0",
        straggler=NOBODY,
        levels=tuple(replace(level, **of_levels) for level in machine.levels),
        pack=copies,
        unpack=copies,
        link_bytes_per_s=UNLIMITED,
        injection_bytes_per_s=UNLIMITED,
        test=TestCost(test_ps, test_ps, test_ps, test_ps, test_ps),
    )


def agree(case: Case) -> int:
    """The makespan, once oracle and engines have the same integers and the same log."""
    expected, *others = (run(name, case) for name in IMPLEMENTATIONS)
    for other in others:
        assert other == expected
    return expected.makespan_ps


FAR_APART = st.sampled_from([0, 1, 10**3, 10**12])


@settings(max_examples=CASES)
@given(seed=seeds, times=st.tuples(*[FAR_APART] * 6), test_ps=FAR_APART, copy_ps=FAR_APART)
def test_costs_a_billionfold_apart(
    seed: int, times: tuple[int, ...], test_ps: int, copy_ps: int
) -> None:
    case = random_case(seed)
    agree(replace(case, machine=priced(case.machine, times, test_ps, copy_ps)))


@settings(max_examples=CASES)
@given(seed=seeds)
def test_a_machine_that_costs_nothing(seed: int) -> None:
    case = random_case(seed)
    assert agree(replace(case, machine=priced(case.machine, (0,) * 6, 0, 0))) == 0


def test_profits_of_nothing_are_one() -> None:
    case = random_case(11)
    machine = priced(case.machine, (0,) * 6, 0, 0)
    policies = [simmpp.PolicyParameters(name) for name in ("object", "ray", "replicated")]
    results = [simmpp.simulate(case.workload, machine, case.placement, p) for p in policies]
    assert [profit.time for profit in profits(results)] == [1.0] * 3


@settings(max_examples=CASES)
@given(seed=seeds, fullness=st.floats(1e-6, 2.0), engine=st.sampled_from(sorted(ENGINES)))
def test_a_slower_clock_gives_the_same_run_up_to_its_limit(
    seed: int, fullness: float, engine: str
) -> None:
    """All times f times as long: the makespan is exactly f times as long, or the run is refused."""
    case = random_case(seed)
    policy = replace(case.policy, refresh_ps=None, load_info="piggyback", sample_ps=None)
    case = replace(case, policy=policy)  # which has no times of its own

    def run_at(factor: int) -> Outcome:
        times = tuple(factor * time for time in (3, 2, 1, 5, 1, 7))
        machine = priced(case.machine, times, 11 * factor, 2 * factor)
        return run(engine, replace(case, machine=machine))

    once = run_at(1)
    assume(once.makespan_ps > 0)  # else there are no rays
    factor = max(1, int(fullness * CLOCK_LIMIT_PS) // once.makespan_ps)
    try:
        slow = run_at(factor)
    except ConfigError as refused:
        assert re.search(f"clock|from 0 to {CLOCK_LIMIT_PS}$", str(refused))
        # Bounds are careful: they may refuse a run that would have used a few percent.
        assert factor * once.makespan_ps > CLOCK_LIMIT_PS // 10**5
    else:
        assert slow.makespan_ps == factor * once.makespan_ps <= CLOCK_LIMIT_PS
        assert slow.messages_by_kind == once.messages_by_kind
        for account in ("compute_ps", "communication_ps", "waiting_ps"):
            assert getattr(slow, account) == [factor * each for each in getattr(once, account)]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"ray_bytes": 2**61}, "could exceed|exceeds the clock"),
        ({"header_bytes": 2**62}, "could exceed|exceeds the clock"),
        ({"header_bytes": 2**70}, "expected an integer from 0 to"),
        ({"latency_ps": 2**63}, "expected an integer from 0 to"),
        ({"latency_ps": 1.5}, "expected an integer from 0 to"),
        ({"latency_ps": float("nan")}, "expected an integer from 0 to"),
        ({"ray_ps": float("inf")}, "expected an integer from 0 to"),
        ({"ray_ps": -1}, "expected an integer from 0 to"),
        ({"ray_ps": True}, "expected an integer from 0 to"),
        ({"quantum": 2**40}, "expected a quantum"),
        ({"link_bytes_per_s": 2**62 + 1}, "expected an integer from 0 to"),
        ({"test": TestCost(1, 1, 1, 2**62)}, "exceeds the clock"),
        ({"shape": (-2, -2, 1)}, "expected an integer from 0 to"),
    ],
)
def test_constants_that_no_run_could_bear(engine: str, change: dict, problem: str) -> None:
    case = next(c for c in map(random_case, range(1000)) if c.workload.n_tests > 20)
    case = replace(
        case,
        workload=replace(case.workload, object_kinds=np.full_like(case.workload.object_kinds, 3)),
    )
    machine = replace(case.machine, **change)
    with pytest.raises(ConfigError, match=problem) as refused:
        simmpp.simulate(case.workload, machine, case.placement, case.policy, engine=engine)
    assert "\n" not in str(refused.value)


def test_the_largest_objects_are_counted_exactly() -> None:
    """Objects of 2^40 bytes, the largest that a file may have: bytes and times are exact."""
    n_bytes = 2**40
    workload = workload_of(1, [[0]], object_bytes=[n_bytes])
    machine = replace(
        simmpp.make_machine("t3e", processors=2),
        link_bytes_per_s=10**12,
        injection_bytes_per_s=UNLIMITED,
        pack=(FREE,) * 4,
        unpack=(FREE,) * 4,
    )
    case = Case(workload, machine, placement_of([1], [0], 2), simmpp.PolicyParameters("object"))
    agree(case)
    outcome = run("compiled", case)
    assert outcome.bytes_sent == n_bytes + 2 * machine.header_bytes + machine.request_bytes
    assert outcome.makespan_ps > n_bytes  # a byte takes a picosecond


# --- shapes ---


@pytest.mark.parametrize("shape", [(1, 1, 4096), (1, 4096, 1), (4099, 1, 1), (2, 1, 2048)])
def test_long_thin_tori(shape: tuple[int, int, int]) -> None:
    """A ray and its object at opposite ends: the request and the object pass half of the ring."""
    machine = replace(simmpp.make_machine("t3e", processors=int(np.prod(shape))), shape=shape)
    nb = machine.processors
    far = max(range(nb), key=lambda pe: (hops(*machine.shape, 0, pe), -pe))
    across = hops(*machine.shape, 0, far)
    assert across == sum(size // 2 for size in shape)
    workload = workload_of(1, [[0]], object_bytes=[0])
    costless = priced(machine, (0, 0, 0, 5, 7, 3), 11, 0)
    case = Case(workload, costless, placement_of([far], [0], nb), simmpp.PolicyParameters("object"))
    for engine in ENGINES:
        assert run(engine, case).makespan_ps == 2 * (5 + 7 * across) + 11 + 3


@pytest.mark.parametrize("processors", [1, 2, 3, 5, 7, 11, 13])
@pytest.mark.parametrize("policy", ["object", "ray", "concurrent"])
def test_one_pe_and_prime_numbers_of_them(processors: int, policy: str) -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:2"), simmpp.Picture(resolution=7))
    machine = simmpp.make_machine("t3e", processors=processors)
    assert sorted(machine.shape) == [1, 1, processors]
    memory = simmpp.Memory(fraction=Fraction(1, 4))
    for pixels in ("blocks", "rows", simmpp.Cells(2), "tiles", "interleaved", "random"):
        rules = simmpp.PlacementRules(pixels=pixels)
        placement = simmpp.place(workload, processors, memory, rules, 0)
        case = Case(workload, machine, placement, simmpp.PolicyParameters(policy, batch=9))
        agree(case)


@pytest.mark.parametrize("processors", [65521, 65536])
def test_the_most_pes_with_next_to_nothing_to_do(processors: int) -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:1"), simmpp.Picture(resolution=3))
    machine = simmpp.make_machine("t3e", processors=processors)
    placement = simmpp.place(workload, processors, simmpp.Memory(), simmpp.PlacementRules(), 0)
    policy = simmpp.PolicyParameters("concurrent")
    one, other = (
        simmpp.simulate(workload, machine, placement, policy, engine=engine) for engine in ENGINES
    )
    assert one.rays == workload.n_rays and one.tests == workload.n_tests
    assert (one.makespan_ps, one.messages, one.events) == (
        other.makespan_ps,
        other.messages,
        other.events,
    )
    assert np.array_equal(one.waiting_ps, other.waiting_ps)
    accounts = one.compute_ps + one.communication_ps + one.waiting_ps
    assert (accounts == one.makespan_ps).all()
