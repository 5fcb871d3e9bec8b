"""Long runs tell how many rays are left."""

from __future__ import annotations

from fractions import Fraction

import pytest

import simmpp
from simmpp.engine.simulate import ENGINES


@pytest.mark.parametrize("engine", ENGINES)
def test_progress_is_reported(engine: str) -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:3"), simmpp.Picture(resolution=32))
    memory = simmpp.Memory(fraction=Fraction(0))
    placement = simmpp.place(workload, 16, memory, simmpp.PlacementRules(), 0)
    machine = simmpp.make_machine(processors=16)
    told: list[int] = []
    simmpp.simulate(
        workload,
        machine,
        placement,
        simmpp.PolicyParameters("object", merge_requests=False),
        engine=engine,
        progress=told.append,
    )
    assert told
    assert all(0 <= rays_left <= workload.n_rays for rays_left in told)
