"""Edges of what can be asked for: nothing to do, one PE, more PEs than objects, a full clock."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from builders import on_torus, random_case
from by_hand import OBJECT, case_of
from implementations import run as run_case_on

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.engine.simulate import ENGINES
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.machine import FAT_TREE, LEVELS, FatTree, Level
from simmpp.machine.torus import LINKS, NO_CONTENTION
from simmpp.policy.parameters import POLICIES
from simmpp.scene.scene import Camera, Scene

PICTURE = simmpp.Picture(resolution=4)
EMPTY = Scene("empty", (), (), (), Camera(eye=(0, 0, -5), at=(0, 0, 0), up=(0, 1, 0)))


def run(
    scene: Scene, processors: int, fraction: Fraction, policy: str, engine: str
) -> simmpp.Result:
    workload = simmpp.trace(scene, PICTURE)
    memory = simmpp.Memory(fraction=fraction)
    placement = simmpp.place(workload, processors, memory, simmpp.PlacementRules(), 0)
    machine = simmpp.make_machine(processors=processors)
    return simmpp.simulate(
        workload, machine, placement, simmpp.PolicyParameters(policy), engine=engine
    )


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("policy", POLICIES)
def test_an_empty_scene_costs_its_rays(policy: str, engine: str) -> None:
    result = run(EMPTY, 4, Fraction(1, 2), policy, engine)
    assert (result.rays, result.tests, result.messages) == (16, 0, 0)
    assert result.makespan_ps == 4 * 6_000_000


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("policy", POLICIES)
def test_one_processor_needs_no_messages(policy: str, engine: str) -> None:
    result = run(simmpp.load_scene("tetra:2"), 1, Fraction(0), policy, engine)
    assert result.messages == 0
    assert result.makespan_ps == result.compute_ps.sum()


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("fraction", [Fraction(0), Fraction(1)])
def test_more_processors_than_objects_and_pixels(
    fraction: Fraction, policy: str, engine: str
) -> None:
    scene = simmpp.load_scene("tetra:1")
    result = run(scene, 37, fraction, policy, engine)
    alone = run(scene, 1, Fraction(1), policy, engine)
    assert (result.rays, result.tests) == (alone.rays, alone.tests)
    assert result.compute_ps.sum() == alone.makespan_ps
    assert (result.messages == 0) == (fraction == 1 or policy == "replicated")


@pytest.mark.parametrize("engine", ENGINES)
def test_a_full_clock_is_an_error_and_never_wraps(engine: str) -> None:
    case = next(c for c in map(random_case, range(1000)) if c.workload.n_rays > 20)
    run_case = (case.workload, case.machine, case.placement, simmpp.PolicyParameters("object"))
    assert simmpp.simulate(*run_case, engine=engine).makespan_ps < CLOCK_LIMIT_PS
    computing = replace(case.machine, ray_ps=CLOCK_LIMIT_PS // 20)
    waiting = replace(on_torus(case).machine, latency_ps=CLOCK_LIMIT_PS)
    tree = replace(waiting, topology=FAT_TREE, fat_tree=FatTree(2))
    levels = (Level("near", 2), Level("far", latency_ps=CLOCK_LIMIT_PS))
    in_blocks = replace(on_torus(case).machine, topology=LEVELS, levels=levels)
    dear = (Level("near", 2), Level("far", send_startup_ps=CLOCK_LIMIT_PS // 2))
    of_levels = replace(in_blocks, levels=dear)
    for machine in (computing, waiting, tree, in_blocks, of_levels):
        with pytest.raises(ConfigError, match="exceeds the clock"):
            simmpp.simulate(case.workload, machine, *run_case[2:], engine=engine)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("each_s", [400_000, 2_250_000])
def test_waiting_for_links_beyond_the_clock_is_an_error(engine: str, each_s: int) -> None:
    # No flight takes half of the clock, but PE 0's ejection port takes one request at a time
    rays = [(pe, [0]) for pe in range(1, 13)]
    slow = {"header_bytes": each_s, "link_bytes_per_s": 1, "shape": (13, 1, 1)}
    alone = run_case_on(engine, case_of(OBJECT, rays, contention=NO_CONTENTION, **slow))
    assert alone.makespan_ps < CLOCK_LIMIT_PS
    with pytest.raises(ConfigError, match="exceeds the clock"):
        run_case_on(engine, case_of(OBJECT, rays, contention=LINKS, **slow))
