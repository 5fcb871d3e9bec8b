"""Rays of other kinds: repeated and scaled tests, rounds, tallies; every integer is the oracle's.

SIMMPP_TEST_CASES and SIMMPP_TEST_FIRST_SEED as in ``test_engine_equals_oracle``.
"""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import asdict, replace

import numpy as np
import pytest
from builders import (
    Case,
    random_case,
    served,
    some_stealing,
    with_capacity,
    with_other_rays,
    with_repeats,
)
from implementations import result_of, run
from numpy.typing import NDArray

from simmpp.engine.simulate import ENGINES
from simmpp.machine.machine import SERVICES
from simmpp.workload.tallies import tally_of, tally_of_tests
from simmpp.workload.workload import FORM_FACTOR, Workload

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "40"))
FIRST_SEED = int(os.environ.get("SIMMPP_TEST_FIRST_SEED", "0"))
SEEDS = range(FIRST_SEED, FIRST_SEED + CASES)


def other_case(seed: int) -> Case:
    """The random case of a seed with rays of other kinds; each fifth has a capacity."""
    case, rng = random_case(seed), np.random.default_rng((seed, 20))
    workload = with_other_rays(rng, with_repeats(rng, case.workload))
    window = int(rng.choice((1, 1, 2, 3)))
    tallies = str(rng.choice(("send", "send", "send", "reduce")))
    if seed % 5 == 0 or case.placement.islands > 1:
        tallies = "reduce"
    placement = replace(case.placement, window=window, tallies=tallies)
    if rng.random() < 0.7:
        drawn = rng.integers(0, int(rng.integers(2, 7)), workload.n_primaries)
        rounds = np.unique(drawn, return_inverse=True)[1].astype(np.int32)
        workload = replace(workload, root_rounds=rounds if rounds.any() else rounds[:0])
    if rng.random() < 0.7:
        workload = replace(workload, object_results=rng.integers(1, 4000, workload.n_objects))
    if seed % 2:
        workload = replace(workload, kinds=as_patches(workload))
    case = replace(case, workload=workload, placement=placement)
    if placement.window == 1:
        case = some_stealing(case, seed)
    if seed % 5 == 0:
        return with_capacity(case, seed)
    return served(case, SERVICES[seed % len(SERVICES)], seed)


def as_patches(workload: Workload) -> NDArray[np.uint8]:
    """Kinds of the same rays, roots being those of patches: each round begins with a maximum."""
    kinds = workload.kinds.copy()
    kinds[: workload.n_primaries] = FORM_FACTOR
    return kinds


@pytest.mark.parametrize("engine", ENGINES)
def test_every_integer_is_the_oracles(engine: str) -> None:
    for seed in SEEDS:
        case = other_case(seed)
        expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"


def test_random_machines_do_all_of_this() -> None:
    found = Counter[str]()
    for seed in SEEDS:
        case = other_case(seed)
        result = result_of("compiled", case)
        at_once = replace(case.placement, window=10**6, tallies="none")
        on_time = replace(case, placement=at_once, policy=replace(case.policy, steal="none"))
        found["barriers"] += result.barriers > 0
        found["windows"] += result.barriers > 0 and case.placement.window > 1
        found["maxima"] += result.barriers > 0 and FORM_FACTOR in case.workload.kinds
        found["deposits"] += result.deposits > 0
        found["reductions"] += result.reduction_ps > 0
        found["bounded"] += result.barriers > 0 and case.placement.capacity is not None
        found["rounds with deposits"] += result.deposits > 0 and result.barriers > 0
        found["waits"] += result.makespan_ps > result_of("compiled", on_time).makespan_ps
    assert min(found.values()) > len(SEEDS) // 20 and len(found) == 8, found


def test_tallies_of_simulated_tests_are_those_of_the_workload() -> None:
    for seed in SEEDS:
        case = other_case(seed)
        result = result_of("compiled", case)
        assert result.tested_rays is not None and result.tested_objects is not None
        told = tally_of(case.workload)
        made = tally_of_tests(case.workload, result.tested_rays, result.tested_objects)
        for mine, others in zip(told, made, strict=True):
            np.testing.assert_array_equal(mine, others, strict=True)
        if case.placement.tallies == "send" and len(case.workload.object_results):
            assert result.deposits <= made.counts[case.workload.object_results > 0].sum()
