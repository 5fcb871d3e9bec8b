"""What every policy has to keep, whatever it decides: the checks of ``simmpp policy check``.

Each random machine is run three times: in the compiled engine, in the SimPy engine, and in the
SimPy engine with the policy's hooks as plain Python, which shares nothing with what numba makes of
them. All integers have to be the same.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import simmpp
from simmpp.common.compiled import njit
from simmpp.common.errors import ModelError
from simmpp.engine.record.recording import Recording
from simmpp.engine.result import Result
from simmpp.engine.simulate import ENGINES, simulate
from simmpp.methods.simulation import integers
from simmpp.policy.hooks import address_of
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.plain import PlainHooks
from simmpp.policy.record import VIEW, consult
from simmpp.studies.policies.machines import Case, random_case
from simmpp.workload.trace.verify import verify

MACHINES = 50
CALLS = 1_000_000
SCENE, PICTURE, PROCESSORS = "mountain:3", simmpp.Picture(resolution=16), 6


@dataclass(frozen=True)
class Finding:
    """What one check has found."""

    check: str
    is_kept: bool
    text: str


def findings(policy: PolicyParameters, tick: Callable[[], None]) -> Iterator[Finding]:
    """Check by check; ``tick`` is called after each of the MACHINES.

    Raises ConfigError for a hook that raises or can't be compiled, with file and line.
    """
    cases = [random_case(policy, seed) for seed in range(MACHINES)]
    plain = PlainHooks()
    yield from _same_on_all(cases, plain, tick)
    if (send := policy.rules.send) in plain.answered_bool:
        name = getattr(send, "__name__", "send")
        text = f"{name} says true or false, which is 1 or 0 rays; v.waiting is all of them"
        yield Finding("how many", False, text)
    yield _same_picture(policy)
    for what, hook in policy.rules.hooks.items():
        ns = _ns_a_call(address_of(hook, tuple(policy.rules.parameters)), policy)
        yield Finding(f"speed of {what}", True, f"{ns:.1f} ns a call")


def _same_on_all(
    cases: list[Case], plain: PlainHooks, tick: Callable[[], None]
) -> Iterator[Finding]:
    """The three runs of each machine, until they differ or starve."""
    sent = asked = said = dropped = 0
    for case in cases:
        try:
            runs = [_run(case, engine) for engine in ENGINES] + [_run(case, "simpy", plain)]
        except ModelError as error:
            yield Finding("no ray starves", False, f"machine {case.seed}: {error}")
            return
        expected = integers(runs[0])
        for run, how in zip(runs[1:], ("the SimPy engine", "plain Python"), strict=True):
            if problem := _difference(expected, integers(run)):
                text = f"machine {case.seed}: {problem} compiled and in {how}"
                yield Finding("one result", False, text)
                return
        sent += expected["ray_messages"]
        asked += expected["objects_fetched"]
        said += expected["user_messages"]
        dropped += expected["user_dropped"]
        tick()
    yield Finding("no ray starves", True, f"on {len(cases)} random machines")
    yield Finding("one result", True, "compiled, in the SimPy engine, and as plain Python")
    did = f"{sent} messages of rays, {asked} objects fetched"
    own = f", {said} messages of its own ({dropped} more than may be)" if said or dropped else ""
    yield Finding("what it does", True, did + own)


def _difference(one: dict[str, int], other: dict[str, int]) -> str:
    differing = [name for name in one if one[name] != other[name]]
    return f"{differing[0]} is {one[differing[0]]} and {other[differing[0]]}" if differing else ""


def _run(case: Case, engine: str, plain: PlainHooks | None = None) -> Result:
    return simulate(
        case.workload,
        case.machine,
        case.placement,
        case.policy,
        engine=engine,
        ready_order=case.ready_order,
        seed=case.seed,
        plain_hooks=plain,
    )


def _same_picture(policy: PolicyParameters) -> Finding:
    """Does the picture of the tests that its PEs made equal the sequential one?"""
    scene = simmpp.load_scene(SCENE)
    workload = simmpp.trace(scene, PICTURE)
    memory, rules = simmpp.Memory(), simmpp.PlacementRules()
    placement = simmpp.place(workload, PROCESSORS, memory, rules, 0)
    machine, record = simmpp.make_machine(processors=PROCESSORS), Recording(tests=True)
    try:
        result = simulate(workload, machine, placement, policy, record=record)
    except ModelError as error:
        return Finding("same picture", False, str(error))
    nothing = np.zeros(0, np.int32)
    rays, objects = (
        nothing if each is None else each for each in (result.tested_rays, result.tested_objects)
    )
    problem = verify(scene, PICTURE, workload, rays, objects)
    return Finding("same picture", problem is None, str(problem or f"bit for bit ({SCENE})"))


def _ns_a_call(address: int, policy: PolicyParameters) -> float:
    """Of a hook, its view filled already."""
    views = np.zeros(1, VIEW)
    for name, value in {
        "load": 90,
        "known_load": 40,
        "waiting": 20,
        "unasked": 20,
        "nb": 8,
    }.items():
        views[name] = value
    views["parameter"][:, : len(policy.numbers)] = policy.numbers
    _call(address, views, 1000)
    began_s = time.thread_time()
    _call(address, views, CALLS)
    return (time.thread_time() - began_s) / CALLS * 1e9


@njit
def _call(address: int, views: NDArray[np.void], n: int) -> int:
    total = 0
    for _ in range(n):
        total += consult(address, views[0])
    return total
