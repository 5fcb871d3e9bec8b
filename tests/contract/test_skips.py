"""What is skipped changes nothing: every skip turned off gives the same integers and rays.

Runs in which nothing is remote are compared with the event loop of the same engine, and with that
of SimPy, which skips nothing. SIMMPP_TEST_CASES says on how many random machines (300 if unset).
"""

from __future__ import annotations

import dataclasses
import os
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from builders import Case, everywhere, random_case, random_workload, with_policy

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.engine import compiled_engine
from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.initial import new_state
from simmpp.engine.local_only import run_alone
from simmpp.engine.result import Result
from simmpp.engine.state import State
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.workload.trace import tracer
from simmpp.workload.trace.generations import Spawning
from simmpp.workload.workload import Workload

CASES = int(os.environ.get("SIMMPP_TEST_CASES", "300"))


@pytest.fixture
def attempts(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether each compiled run that could do without events did."""
    made: list[bool] = []

    def attempt(runs: object) -> bool:
        made.append(run_alone(runs))
        return made[-1]

    monkeypatch.setattr(compiled_engine, "run_alone", attempt)
    return made


def everything(result: Result) -> dict[str, object]:
    """All that a result says but the name of its engine."""
    fields = {f.name: getattr(result, f.name) for f in dataclasses.fields(result)}
    del fields["engine"]
    return {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in fields.items()}


def run(case: Case, engine: str = "compiled") -> dict[str, object]:
    """A run that keeps no log and no tests, and so may do without events."""
    return everything(
        simmpp.simulate(
            case.workload,
            case.machine,
            case.placement,
            case.policy,
            engine=engine,
            ready_order=case.ready_order,
        )
    )


def by_events(case: Case) -> dict[str, object]:
    """The same in the compiled event loop: the skip is turned off."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled_engine, "run_alone", lambda runs: False)
        return run(case)


def nothing_remote(seed: int) -> Case:
    """A random machine whose PEs need nobody, for one reason or another."""
    case = random_case(seed)
    if seed % 3 == 0:
        return with_policy(case, name="replicated")
    return replace(case, placement=everywhere(case.placement))


@pytest.mark.parametrize("first_seed", range(0, CASES, 25))
def test_without_events_every_integer_is_the_same(first_seed: int, attempts: list[bool]) -> None:
    for seed in range(first_seed, min(first_seed + 25, CASES)):
        case = nothing_remote(seed)
        got = run(case)
        assert got == by_events(case), f"seed {seed}"
        assert got == run(case, "simpy"), f"seed {seed}"
    assert attempts and all(attempts)


@pytest.mark.parametrize("first_seed", range(0, CASES, 25))
def test_with_something_remote_nothing_is_skipped(first_seed: int, attempts: list[bool]) -> None:
    for seed in range(first_seed, min(first_seed + 25, CASES)):
        case = random_case(seed)
        assert run(case) == by_events(case), f"seed {seed}"
    assert not all(attempts)


@pytest.mark.parametrize("order", ["depth-first", "breadth-first"])
@pytest.mark.parametrize("spec", ["mountain:3", "rings:1", "tetra:3", "balls:1"])
@pytest.mark.parametrize("processors", [1, 7, 64])
def test_on_scenes(spec: str, order: str, processors: int, attempts: list[bool]) -> None:
    workload = simmpp.trace(simmpp.load_scene(spec), simmpp.Picture(resolution=32))
    rules, memory = simmpp.PlacementRules(pixels="tiles"), simmpp.Memory(fraction=Fraction(1))
    placement = simmpp.place(workload, processors, memory, rules, seed=0)
    for quantum, probe_ps in ((1, 7), (5, 10**6), (64, 0)):
        machine = simmpp.make_machine(processors=processors)
        machine = replace(machine, quantum=quantum, probe_ps=probe_ps)
        for name in ("object", "concurrent"):
            policy = simmpp.PolicyParameters(name)
            case = Case(workload, machine, placement, policy, order)
            assert run(case) == by_events(case)
    assert attempts and all(attempts)


def test_the_most_rays_may_be_held_after_the_start(attempts: list[bool]) -> None:
    """Deep trees on few pixels: the peak lies within the first trees, not at the start."""
    later = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        workload, case = random_workload(rng), nothing_remote(seed)
        placement = simmpp.Memory(fraction=Fraction(1)), simmpp.PlacementRules(), seed
        placed = simmpp.place(workload, case.machine.processors, *placement)
        case = replace(case, workload=workload, placement=placed, ready_order="depth-first")
        got = run(case)
        assert got == by_events(case)
        later += max(got["pe_peak_rays"]) > np.bincount(placed.pixel_pes, minlength=1).max()  # type: ignore[operator]
    assert later > 5


@pytest.mark.parametrize("engine", ["compiled", "simpy"])
def test_a_full_clock_is_an_error_without_events_too(engine: str) -> None:
    case = next(case for case in map(nothing_remote, range(20)) if case.workload.n_tests > 20)
    machine = replace(case.machine, probe_ps=CLOCK_LIMIT_PS // 3, quantum=1, shape=(1, 1, 1))
    owners = np.zeros(case.workload.n_objects, np.int32)
    placement = simmpp.place(
        replace(case.workload, object_centroids=np.zeros((len(owners), 3))),
        1,
        simmpp.Memory(),
        simmpp.PlacementRules(),
        seed=0,
    )
    with pytest.raises(ConfigError, match="clock"):
        run(replace(case, machine=machine, placement=placement), engine)


def same_rays(some: Workload, others: Workload) -> bool:
    fields = dataclasses.fields(Workload)
    pairs = ((getattr(some, f.name), getattr(others, f.name)) for f in fields)
    return all(np.array_equal(a, b) for a, b in pairs)


@pytest.mark.parametrize("spec", ["tetra:3", "mountain:2", "rings:1", "balls:1", "tree:3"])
def test_passes_that_a_scene_does_not_need_would_find_no_rays(
    spec: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without reflective material no reflection, without transparent material no refraction."""
    scene, picture = simmpp.load_scene(spec), simmpp.Picture(resolution=24)
    skipping, chosen = simmpp.trace(scene, picture), tracer.spawning

    def all_passes(*arguments: object) -> Spawning:
        return replace(chosen(*arguments), reflection=True, refraction=True)  # type: ignore[arg-type]

    monkeypatch.setattr(tracer, "spawning", all_passes)
    assert same_rays(skipping, simmpp.trace(scene, picture))


def test_objects_that_no_itinerary_names_take_no_state() -> None:
    """A scene with 50,000 more objects that no ray comes near: nothing moves but resident bytes."""
    for seed in range(20):
        case = random_case(seed)
        case = replace(case, machine=simmpp.make_machine(processors=case.machine.processors))
        bigger = with_idle_objects(case, 50_000)
        got, expected = run(bigger), run(case)
        assert got == expected
        states = [state_of(each) for each in (case, bigger)]
        for name in ("miss_marks", "peer_marks"):
            few, many = (state.arrays[name][USED] for state in states)
            assert few == many


def with_idle_objects(case: Case, n: int) -> Case:
    """The case with n more objects of 0 bytes, owned in turn, that no ray is tested against."""
    workload, placement = case.workload, case.placement
    n_objects = workload.n_objects + n
    owners = np.arange(n_objects, dtype=np.int32) % (placement.processors // placement.islands)
    owners[: workload.n_objects] = placement.owners
    more = {
        name: np.concatenate([getattr(workload, name), np.zeros(n, getattr(workload, name).dtype)])
        for name in ("object_kinds", "object_triangles", "object_bytes")
    }
    more["object_centroids"] = np.zeros((n_objects, 3))
    return replace(
        case, workload=replace(workload, **more), placement=replace(placement, owners=owners)
    )


def state_of(case: Case) -> State:
    """The state of a case when it has been run."""
    state = new_state(
        case.workload,
        case.machine,
        case.placement,
        case.policy,
        ready_order=case.ready_order,
    )
    compiled_engine.CompiledRun(state).run()
    return state


def test_progress_is_told_without_events_too() -> None:
    told: list[int] = []
    case = nothing_remote(1)
    parts = case.workload, case.machine, case.placement, case.policy
    simmpp.simulate(*parts, progress=told.append)
    assert told == [0]
