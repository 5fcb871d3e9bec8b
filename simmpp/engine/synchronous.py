"""The step-by-step machine that the paper's analytical model describes, message by message.

All rays that are alive make one test per step; a barrier ends the step (Nebel 1998, section 3.1,
steps 3 to 6). In object dataflow each ray whose object is missing sends a request of its own; in
ray dataflow each PE sends one message to every other PE, with rays or without. The network takes no
time. Each PE has its own clock, advanced by the costs of one message, test or ray after the other.

Within a step the model lets no PE wait: a message is at hand when its receiver gets to it.
``waits`` makes the receiver wait until the message has been sent, which shows how much that
assumption hides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.compiled import njit
from simmpp.engine.counts import Counter, Counts
from simmpp.machine.machine import Machine
from simmpp.machine.messages import OBJECT, RAYS, REQUEST
from simmpp.machine.network import transfer_ps
from simmpp.machine.work import total_compute_ps
from simmpp.placement.placement import Placement
from simmpp.workload.workload import Workload

Dataflow = Literal["object", "ray"]
DATAFLOWS: tuple[Dataflow, ...] = ("object", "ray")

Clocks = NDArray[np.int64]
Rays = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class SynchronousResult:
    """Times of a synchronous run, and the n and r that it had."""

    times_ps: NDArray[np.int64]
    """(K, nb) int64: what each PE worked (and waited for messages, with ``waits``) in each step."""
    counts: Counts

    @property
    def makespan_ps(self) -> int:
        """Every step takes as long as its slowest PE."""
        return int(self.times_ps.max(axis=1, initial=0).sum())


class _World(NamedTuple):
    """What does not change in a run."""

    itinerary_offsets: NDArray[np.int64]
    itinerary_objects: Rays
    child_offsets: Rays
    owners: Rays
    resident: NDArray[np.bool_]
    """(nb, N): object in the memory of the PE."""
    object_bytes: NDArray[np.int64]
    test_ps: NDArray[np.int64]
    send_ps: int
    receive_ps: int
    ray_ps: int
    pack: NDArray[np.int64]
    """(4, 2): fixed ps and bytes per second by message kind."""
    unpack: NDArray[np.int64]
    request_bytes: int
    ray_bytes: int
    waits: bool


class _Step(NamedTuple):
    """What one step counts and times; arrays of nb, and r."""

    clocks: Clocks
    tests: NDArray[np.int64]
    ended: NDArray[np.int64]
    r: NDArray[np.int64]
    """(nb, nb): rays on PE i that need an object of PE j and not of i."""


def synchronous(
    workload: Workload,
    machine: Machine,
    placement: Placement,
    dataflow: Dataflow,
    *,
    waits: bool = False,
) -> SynchronousResult:
    """Run a workload step by step.

    Raises ConfigError if the total of all tests exceeds the clock.
    """
    total_compute_ps(workload, machine)
    world = _world(workload, machine, placement, waits)
    nb = machine.processors
    at = workload.itinerary_offsets[:-1].copy()
    pe_of = np.zeros(workload.n_rays, np.int32)
    pe_of[: workload.n_primaries] = placement.pixel_pes
    alive = np.arange(workload.n_primaries, dtype=np.int32)
    step_of = _object_step if dataflow == "object" else _ray_step
    counter, times = Counter(nb), [np.zeros(nb, np.int64)][:0]
    while len(alive):
        step = _new_step(nb)
        missing = _needs(world, step, alive, at, pe_of)
        step_of(world, step, alive, missing, at, pe_of)
        alive = _next_rays(world, alive, at, pe_of)
        counter.add(step.tests, step.ended, step.r)
        times.append(step.clocks)
    return SynchronousResult(np.array(times, np.int64).reshape(-1, nb), counter.counts())


def _world(workload: Workload, machine: Machine, placement: Placement, waits: bool) -> _World:
    def copies(costs: Any) -> NDArray[np.int64]:
        return np.array([(cost.fixed_ps, cost.bytes_per_s) for cost in costs], np.int64)

    return _World(
        workload.itinerary_offsets,
        workload.itinerary_objects,
        workload.child_offsets,
        placement.owners,
        _residency(placement),
        workload.object_bytes,
        machine.test.of_objects(workload),
        machine.send_startup_ps,
        machine.receive_startup_ps,
        machine.ray_ps,
        copies(machine.pack),
        copies(machine.unpack),
        machine.request_bytes,
        machine.ray_bytes,
        waits,
    )


def _new_step(nb: int) -> _Step:
    clocks, tests, ended = np.zeros((3, nb), np.int64)
    return _Step(clocks, tests, ended, np.zeros((nb, nb), np.int64))


def _residency(placement: Placement) -> NDArray[np.bool_]:
    nb, n_objects = placement.processors, len(placement.owners)
    resident = np.zeros((nb, n_objects), np.bool_)
    resident[placement.owners, np.arange(n_objects)] = True
    holders = np.repeat(np.arange(nb), np.diff(placement.replica_offsets))
    resident[holders, placement.replica_objects] = True
    return resident


@njit
def _needs(
    world: _World, step: _Step, alive: Rays, at: NDArray[np.int64], pe_of: Rays
) -> NDArray[np.bool_]:
    """Count r; whether the object of each ray alive is missing: (alive,) bool."""
    missing = np.zeros(alive.size, np.bool_)
    for n in range(alive.size):
        ray = alive[n]
        if at[ray] < world.itinerary_offsets[ray + 1]:
            wanted, here = world.itinerary_objects[at[ray]], pe_of[ray]
            if not world.resident[here, wanted]:
                missing[n] = True
                step.r[here, world.owners[wanted]] += 1
    return missing


@njit
def _object_step(
    world: _World,
    step: _Step,
    alive: Rays,
    missing: NDArray[np.bool_],
    at: NDArray[np.int64],
    pe_of: Rays,
) -> None:
    """Ask for every missing object, serve what others ask for, test."""
    clocks = step.clocks
    asking = alive[missing]
    departs = np.zeros(asking.size, np.int64)
    for n in range(asking.size):
        me = pe_of[asking[n]]
        clocks[me] += world.send_ps + _copy_ps(world.pack, REQUEST, world.request_bytes)
        departs[n] = clocks[me]
    for n in np.argsort(departs, kind="mergesort"):
        wanted = world.itinerary_objects[at[asking[n]]]
        me, size = world.owners[wanted], world.object_bytes[wanted]
        _arrive(world, clocks, me, departs[n])
        clocks[me] += world.receive_ps + _copy_ps(world.unpack, REQUEST, world.request_bytes)
        clocks[me] += world.send_ps + _copy_ps(world.pack, OBJECT, size)
        departs[n] = clocks[me]
    _test_all(world, step, alive[~missing], at, pe_of)
    for n in np.argsort(departs, kind="mergesort"):
        me, wanted = pe_of[asking[n]], world.itinerary_objects[at[asking[n]]]
        _arrive(world, clocks, me, departs[n])
        size = world.object_bytes[wanted]
        clocks[me] += world.receive_ps + _copy_ps(world.unpack, OBJECT, size)
        _test_all(world, step, asking[n : n + 1], at, pe_of)


@njit
def _ray_step(
    world: _World,
    step: _Step,
    alive: Rays,
    missing: NDArray[np.bool_],
    at: NDArray[np.int64],
    pe_of: Rays,
) -> None:
    """Send one message to every other PE, receive one from each, test the rays that are here."""
    clocks, nb = step.clocks, step.clocks.size
    departs = np.zeros((nb, nb), np.int64)
    for me in range(nb):
        for away in range(1, nb):
            to = (me + away) % nb
            size = step.r[me, to] * world.ray_bytes
            clocks[me] += world.send_ps + _copy_ps(world.pack, RAYS, size)
            departs[me, to] = clocks[me]
    _test_all(world, step, alive[~missing], at, pe_of)
    for me in range(nb):
        for away in range(1, nb):
            source = (me - away) % nb
            _arrive(world, clocks, me, departs[source, me])
            size = step.r[source, me] * world.ray_bytes
            clocks[me] += world.receive_ps + _copy_ps(world.unpack, RAYS, size)
    moving = alive[missing]
    for ray in moving:
        pe_of[ray] = world.owners[world.itinerary_objects[at[ray]]]
    _test_all(world, step, moving, at, pe_of)


@njit
def _arrive(world: _World, clocks: Clocks, me: int, depart_ps: int) -> None:
    """Wait for a message that has not been sent yet."""
    if world.waits:
        clocks[me] = max(clocks[me], depart_ps)


@njit
def _copy_ps(costs: NDArray[np.int64], kind: int, n_bytes: int) -> int:
    return costs[kind, 0] + transfer_ps(n_bytes, costs[kind, 1])


@njit
def _test_all(world: _World, step: _Step, rays: Rays, at: NDArray[np.int64], pe_of: Rays) -> None:
    """One test of each of these rays, where they are; a ray without itinerary has none."""
    for ray in rays:
        me = pe_of[ray]
        end = world.itinerary_offsets[ray + 1]
        if at[ray] < end:
            step.clocks[me] += world.test_ps[world.itinerary_objects[at[ray]]]
            step.tests[me] += 1
            at[ray] += 1
        if at[ray] == end:
            step.clocks[me] += world.ray_ps
            step.ended[me] += 1


@njit
def _next_rays(world: _World, alive: Rays, at: NDArray[np.int64], pe_of: Rays) -> Rays:
    """Rays that go on, and the children of those that ended, on the PE where they ended."""
    n = 0
    for ray in alive:
        ended = at[ray] == world.itinerary_offsets[ray + 1]
        n += world.child_offsets[ray + 1] - world.child_offsets[ray] if ended else 1
    following = np.empty(n, np.int32)
    n = 0
    for ray in alive:
        if at[ray] < world.itinerary_offsets[ray + 1]:
            following[n] = ray
            n += 1
            continue
        for child in range(world.child_offsets[ray], world.child_offsets[ray + 1]):
            pe_of[child] = pe_of[ray]
            following[n] = child
            n += 1
    return following
