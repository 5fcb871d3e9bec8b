"""Rays of patches on both engines and the oracle: the same integers, and the recorded hits."""

from __future__ import annotations

from dataclasses import asdict
from itertools import product

import numpy as np
import pytest
from builders import Case
from implementations import result_of, run
from path_scenes import quad, walls

import simmpp
from simmpp.engine.simulate import ENGINES
from simmpp.scene.scene import Camera, Material, Scene
from simmpp.workload.picture import Picture
from simmpp.workload.radiosity.room import room_of
from simmpp.workload.radiosity.settings import Radiosity
from simmpp.workload.radiosity.source import RadiositySource
from simmpp.workload.radiosity.tracing import trace_patches
from simmpp.workload.tallies import tally_of, tally_of_tests

GREY, LAMP = Material((0.6, 0.6, 0.6)), Material((0.3, 0.3, 0.3), emission=(3.0, 2.0, 1.0))
FACE = quad((3, 3, 9.5), (3, 7, 9.5), (7, 7, 9.5), (7, 3, 9.5), material=1)
OBJECTS = (*walls((0, 0, 0), (10, 10, 10), (0,) * 6), FACE)
SCENE = Scene("room", OBJECTS, (GREY, LAMP), (), Camera((5, 0.3, 5), (5, 10, 4.5)))
SETTINGS = {
    "gathering": Radiosity(patches=40.0, rays=16),
    "shooting": Radiosity(method="shooting", patches=40.0, rays=16, residual=0.2),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("method", SETTINGS)
def test_both_engines_are_the_oracle(method: str) -> None:
    source = RadiositySource(lambda: SCENE, SETTINGS[method])
    workload = trace_patches(room_of(SCENE, SETTINGS[method]), threads=1)
    machine, memory = simmpp.make_machine("t3e", processors=4), simmpp.Memory(fraction=0.4)  # type: ignore[arg-type]
    several: tuple[object, ...] = (
        ("barrier", {"window": 2}) if workload.n_rounds > 1 else ("barrier",)
    )
    for pixels, rounds, policy in product(
        ("home", "interleaved"), several, ("object", "ray", "concurrent")
    ):
        rules = simmpp.PlacementRules(pixels=pixels, rounds=rounds)  # type: ignore[arg-type]
        placement = simmpp.place(workload, 4, memory, rules, seed=3)
        case = Case(workload, machine, placement, simmpp.PolicyParameters(policy))  # type: ignore[arg-type]
        expected = asdict(run("oracle", case))
        for engine in ENGINES:
            got = asdict(run(engine, case))
            differ = [name for name in expected if got[name] != expected[name]]
            assert not differ, (method, pixels, rounds, policy, engine)
        result = result_of("compiled", case)
        assert result.tested_rays is not None
        assert result.tested_objects is not None
        tests = result.tested_rays, result.tested_objects
        assert source.verify(Picture(), workload, *tests) == ""
        told, made = tally_of(workload), tally_of_tests(workload, *tests)
        assert all(np.array_equal(a, b) for a, b in zip(told, made, strict=True))
        assert told.counts.sum() == (workload.hits >= 0).sum()
        assert len(result.round_ends_ps) == workload.n_rounds
        assert result.round_ends_ps.max() + result.reduction_ps == result.makespan_ps
        assert ("residual_tenth_ps" in result.residuals_ps) == bool(
            (workload.round_residuals <= 0.1).any()
        )
        if rounds == "barrier":
            assert (np.diff(result.round_ends_ps) > 0).all()
