"""Every integer that an engine gives is the oracle's, on random small cases.

SIMMPP_TEST_CASES says how many (300 if unset), SIMMPP_TEST_FIRST_SEED where they begin.
"""

from __future__ import annotations

import os
from dataclasses import asdict, replace

import pytest
from builders import SHARING, Case, random_case, some_stealing
from implementations import run

from simmpp.engine.simulate import ENGINES

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "300"))
FIRST_SEED = int(os.environ.get("SIMMPP_TEST_FIRST_SEED", "0"))
CHUNK = 25
"""Seeds of one test: few enough to be told apart, many enough to be quick."""

CHUNKS = range(FIRST_SEED, FIRST_SEED + CASES, CHUNK)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("first_seed", CHUNKS)
def test_every_integer_is_the_oracles(engine: str, first_seed: int) -> None:
    for seed in range(first_seed, min(first_seed + CHUNK, FIRST_SEED + CASES)):
        assert_equal(engine, some_stealing(random_case(seed), seed), seed)


@pytest.mark.parametrize("engine", ENGINES)
def test_every_integer_is_the_oracles_where_rays_and_requests_ride_together(engine: str) -> None:
    for seed in range(FIRST_SEED, FIRST_SEED + max(1, CASES // 4)):
        assert_equal(engine, replace(random_case(seed), policy=SHARING), seed)


def assert_equal(engine: str, case: Case, seed: int) -> None:
    """The engine says what the oracle says."""
    expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
    for name in expected:
        assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
