"""Rays of other kinds: repeated, scaled tests; every integer is the oracle's.

SIMMPP_TEST_CASES and SIMMPP_TEST_FIRST_SEED as in ``test_engine_equals_oracle``.
"""

from __future__ import annotations

import os
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
from implementations import run
from numpy.typing import NDArray

from simmpp.engine.simulate import ENGINES
from simmpp.machine.machine import SERVICES
from simmpp.workload.workload import FORM_FACTOR, Workload

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "60"))
FIRST_SEED = int(os.environ.get("SIMMPP_TEST_FIRST_SEED", "0"))
SEEDS = range(FIRST_SEED, FIRST_SEED + CASES)


def other_case(seed: int) -> Case:
    """The random case of a seed with rays of other kinds; each third has a capacity."""
    case, rng = random_case(seed), np.random.default_rng((seed, 20))
    workload = with_other_rays(rng, with_repeats(rng, case.workload))
    placement = replace(case.placement, window=int(rng.choice((1, 1, 2, 3))))
    if seed % 2:
        workload = replace(workload, kinds=as_patches(workload))
    case = replace(case, workload=workload, placement=placement)
    if placement.window == 1:
        case = some_stealing(case, seed)
    if seed % 3 == 0:
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
