"""What is blamed on a policy's hooks, and what is not."""

from __future__ import annotations

from fractions import Fraction

import pytest

import simmpp
from simmpp.engine.simulate import ENGINES


class Bad:
    """Raises where nobody can catch it."""

    def __del__(self) -> None:
        raise ValueError("someone else's")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_what_a_finaliser_raises_meanwhile_is_no_hooks_fault(engine: str) -> None:
    workload = simmpp.trace(simmpp.load_scene("tetra:3"), simmpp.Picture(resolution=32))
    placement = simmpp.place(
        workload, 16, simmpp.Memory(fraction=Fraction(0)), simmpp.PlacementRules(), 0
    )
    told: list[int] = []

    def progress(rays_left: int) -> None:
        Bad()
        told.append(rays_left)

    result = simmpp.simulate(
        workload,
        simmpp.make_machine(processors=16),
        placement,
        simmpp.PolicyParameters("object", merge_requests=False),
        engine=engine,
        progress=progress,
    )
    assert told and result.makespan_ps > 0
