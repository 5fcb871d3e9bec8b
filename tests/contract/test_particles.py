"""Particles on random machines: every integer is the oracle's, and tests are all their segments.

SIMMPP_TEST_CASES says how many machines (8 if unset).
"""

from __future__ import annotations

import os
from dataclasses import asdict, replace

import numpy as np
import pytest
from builders import Case, random_case, random_placement
from implementations import run
from particle_cells import preset

from simmpp.engine.record.recording import Recording
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.workload.particles.cells import Cells
from simmpp.workload.particles.results import problem_of
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.tracer import trace

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "8"))
ASKED: list[tuple[Cells, Particles]] = [
    (preset("shield"), Particles(count=30, splitting=True)),
    (preset("hohlraum"), Particles(count=30, capture="implicit")),
]


def particle_case(seed: int) -> Case:
    """A random machine with particles, each of which starts where its cell is or anywhere."""
    case, rng = random_case(seed), np.random.default_rng((seed, 31))
    workload = trace(*ASKED[seed % 2], threads=1)
    placement = random_placement(rng, workload, case.machine.processors)
    return replace(case, workload=workload, placement=placement)


@pytest.mark.parametrize("engine", ENGINES)
def test_every_integer_is_the_oracles(engine: str) -> None:
    for seed in range(CASES):
        case = particle_case(seed)
        expected, got = asdict(run("oracle", case)), asdict(run(engine, case))
        for name in expected:
            assert got[name] == expected[name], f"seed {seed}: {name} under {case.policy}"


@pytest.mark.parametrize("engine", ENGINES)
def test_the_tests_of_simulated_pes_are_the_segments(engine: str) -> None:
    for seed in range(2):
        case = particle_case(seed)
        result = simulate(
            case.workload, case.machine, case.placement, case.policy,
            engine=engine, record=Recording(tests=True),
        )  # fmt: skip
        rays, objects = result.tested_rays, result.tested_objects
        assert rays is not None and objects is not None
        assert problem_of(*ASKED[seed % 2], case.workload, rays, objects) == ""
        problem = problem_of(*ASKED[seed % 2], case.workload, rays[1:], objects[1:])
        assert f"ray {rays[0]} is never tested against object {objects[0]}" == problem
    other = replace(ASKED[1][1], seed=1)
    problem = problem_of(ASKED[1][0], other, case.workload, rays, objects)
    assert problem.startswith("particles that are followed again have other")
