"""Whoever computes and whenever: every policy, placement and load info makes the same picture."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Literal, get_args

import numpy as np
import pytest

import simmpp
from simmpp.engine.capacity import needs_of
from simmpp.engine.record.recording import Recording
from simmpp.engine.simulate import ENGINES
from simmpp.placement.placement import Owners, Pixels, Residents
from simmpp.placement.rooms import Capacity
from simmpp.policy.parameters import CEILING, POLICIES
from simmpp.workload.trace.shading import render
from simmpp.workload.trace.verify import verify

PICTURE = simmpp.Picture(resolution=12)
PROCESSORS = 6
NEEDS_HOMES = ("home", "home_spread")
CONCURRENT = simmpp.PolicyParameters("concurrent", min_load=3, batch=8, ask_at_least=2)
POLICIES_AND_INFO = (
    *(replace(CONCURRENT, name=name) for name in POLICIES if name != "concurrent"),
    *(replace(CONCURRENT, load_info=info) for info in ("piggyback", "exact", "none")),  # type: ignore[arg-type]
    replace(CONCURRENT, refresh_ps=10**9),
    *(replace(CONCURRENT, name=name, steal="half") for name in ("concurrent", CEILING)),
)


@pytest.mark.parametrize("spec", ["mountain:3", "rings:1", "tetra:3"])
def test_the_tests_of_every_run_make_the_picture(spec: str) -> None:
    scene = simmpp.load_scene(spec)
    workload = simmpp.trace(scene, PICTURE)
    machine = simmpp.make_machine(processors=PROCESSORS)
    pixels_of = [each for each in get_args(Pixels) if each not in NEEDS_HOMES]
    choices = product(get_args(Owners), get_args(Residents), (*pixels_of, simmpp.Cells(3)))
    for n, (owners, residents, pixels) in enumerate(choices):
        memory = simmpp.Memory(fraction=Fraction(n % 5, 8), residents=residents, transient=n % 3)
        rules = simmpp.PlacementRules(owners, pixels)
        placement = simmpp.place(workload, PROCESSORS, memory, rules, seed=n)
        for policy in POLICIES_AND_INFO:
            for engine in ENGINES if n % 16 == 0 else ("compiled",):
                result = simmpp.simulate(
                    workload,
                    machine,
                    placement,
                    policy,
                    engine=engine,
                    record=Recording(tests=True),
                )
                assert result.tested_rays is not None
                assert result.tested_objects is not None
                found = verify(scene, PICTURE, workload, result.tested_rays, result.tested_objects)
                assert found is None, f"{policy} {rules} {memory}: {found}"


@pytest.mark.parametrize("steal", ["none", "half"])
def test_the_picture_is_the_same_at_every_capacity(steal: Literal["none", "half"]) -> None:
    scene = simmpp.load_scene("mountain:3")
    workload, machine = simmpp.trace(scene, PICTURE), simmpp.make_machine(processors=PROCESSORS)
    memory, rules = simmpp.Memory(fraction="30%", capacity="least"), simmpp.PlacementRules()
    placement = simmpp.place(workload, PROCESSORS, memory, rules, seed=0)
    for name in POLICIES:
        policy = replace(CONCURRENT, name=name, steal=steal)
        least = needs_of(workload, machine, placement, policy).least_bytes
        for more in (0, 200, 1000, 5000, 10**6):
            within = replace(placement, capacity=Capacity(least + more))
            noted = Recording(tests=True)
            run = simmpp.simulate(workload, machine, within, policy, record=noted)
            assert run.tested_rays is not None and run.tested_objects is not None
            found = verify(scene, PICTURE, workload, run.tested_rays, run.tested_objects)
            assert found is None, f"{policy} {more}: {found}"


def test_a_test_left_out_shows() -> None:
    scene = simmpp.load_scene("mountain:3")
    workload = simmpp.trace(scene, PICTURE)
    rays = np.repeat(np.arange(workload.n_rays), np.diff(workload.itinerary_offsets))
    tests = rays.astype(np.int32), workload.itinerary_objects
    assert verify(scene, PICTURE, workload, *tests) is None
    assert verify(scene, PICTURE, workload, tests[0][1:], tests[1][1:]) is not None


def test_a_hit_tampered_with_shows_in_the_picture() -> None:
    scene = simmpp.load_scene("mountain:3")
    workload = simmpp.trace(scene, PICTURE)
    rays = np.repeat(np.arange(workload.n_rays), np.diff(workload.itinerary_offsets))
    hits = workload.hits.copy()
    ray = int(np.flatnonzero((workload.kinds == 0) & (hits >= 0))[0])
    hits[ray] = (hits[ray] + 1) % workload.n_objects
    found = verify(
        scene,
        PICTURE,
        replace(workload, hits=hits),
        rays.astype(np.int32),
        workload.itinerary_objects,
    )
    assert found is not None
    assert found.row * PICTURE.resolution + found.column == workload.pixels[ray]


def test_the_picture_does_not_depend_on_how_it_was_traced() -> None:
    scene = simmpp.load_scene("rings:1")
    first, again = (render(scene, PICTURE, simmpp.trace(scene, PICTURE)) for _ in range(2))
    assert first.tobytes() == again.tobytes()
