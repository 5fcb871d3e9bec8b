"""Every integer that an engine gives is the oracle's, on random small cases.

SIMMPP_TEST_CASES says how many (300 if unset), SIMMPP_TEST_FIRST_SEED where they begin.
"""

from __future__ import annotations

import os
from dataclasses import asdict

import pytest
from builders import random_case
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
        case = random_case(seed)
        expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"
