"""Threads and network cards that serve: every integer is the oracle's, and nothing is lost.

SIMMPP_TEST_CASES and SIMMPP_TEST_FIRST_SEED as in ``test_engine_equals_oracle``.
"""

from __future__ import annotations

import os
from dataclasses import asdict, replace

import pytest
from builders import SHARING, Case, random_case, served
from implementations import run

from simmpp.engine.simulate import ENGINES
from simmpp.machine.machine import NIC, THREAD

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "100"))
FIRST_SEED = int(os.environ.get("SIMMPP_TEST_FIRST_SEED", "0"))
SEEDS = range(FIRST_SEED, FIRST_SEED + CASES)
SERVERS = (THREAD, NIC)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("service", SERVERS)
def test_every_integer_is_the_oracles(engine: str, service: str) -> None:
    for seed in SEEDS:
        assert_equal(engine, served(random_case(seed), service, seed), seed)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("service", SERVERS)
def test_so_it_is_where_rays_and_requests_would_ride_together(engine: str, service: str) -> None:
    for seed in SEEDS[: max(1, CASES // 4)]:
        case = replace(random_case(seed), policy=SHARING)
        assert_equal(engine, served(case, service, seed), seed)


def assert_equal(engine: str, case: Case, seed: int) -> None:
    """The engine says what the oracle says."""
    expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
    for name in expected:
        assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
