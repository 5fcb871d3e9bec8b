"""One step of the synchronous machine: who needs what, and every message of it with its costs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.machine.messages import OBJECT, RAYS, REQUEST
from simmpp.machine.transfer import transfer_ps

Clocks = NDArray[np.int64]
Rays = NDArray[np.int32]


class World(NamedTuple):
    """What is given in a run, and where each of the n rays is by now."""

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
    at: NDArray[np.int64]
    """(n,): the ray's next test, as an index of ``itinerary_objects``."""
    pe_of: Rays
    """(n,): the PE that the ray is on."""


class Step(NamedTuple):
    """What one step counts and times; arrays of nb, and r."""

    clocks: Clocks
    tests: NDArray[np.int64]
    ended: NDArray[np.int64]
    r: NDArray[np.int64]
    """(nb, nb): rays on PE i that need an object of PE j and not of i."""


def new_step(nb: int) -> Step:
    """A step in which nothing has happened yet."""
    clocks, tests, ended = np.zeros((3, nb), np.int64)
    return Step(clocks, tests, ended, np.zeros((nb, nb), np.int64))


@njit
def needs(world: World, step: Step, alive: Rays) -> NDArray[np.bool_]:
    """Count r; whether the object of each ray alive is missing: (alive,) bool."""
    missing = np.zeros(alive.size, np.bool_)
    for n in range(alive.size):
        ray = alive[n]
        if world.at[ray] < world.itinerary_offsets[ray + 1]:
            wanted, here = world.itinerary_objects[world.at[ray]], world.pe_of[ray]
            if not world.resident[here, wanted]:
                missing[n] = True
                step.r[here, world.owners[wanted]] += 1
    return missing


@njit
def object_step(world: World, step: Step, alive: Rays, missing: NDArray[np.bool_]) -> None:
    """Ask for every missing object, serve what others ask for, test."""
    clocks = step.clocks
    asking = alive[missing]
    departs = np.zeros(asking.size, np.int64)
    for n in range(asking.size):
        me = world.pe_of[asking[n]]
        clocks[me] += world.send_ps + _copy_ps(world.pack, REQUEST, world.request_bytes)
        departs[n] = clocks[me]
    for n in np.argsort(departs, kind="mergesort"):
        wanted = world.itinerary_objects[world.at[asking[n]]]
        me, size = world.owners[wanted], world.object_bytes[wanted]
        _arrive(world, clocks, me, departs[n])
        clocks[me] += world.receive_ps + _copy_ps(world.unpack, REQUEST, world.request_bytes)
        clocks[me] += world.send_ps + _copy_ps(world.pack, OBJECT, size)
        departs[n] = clocks[me]
    _test_all(world, step, alive[~missing])
    for n in np.argsort(departs, kind="mergesort"):
        me, wanted = world.pe_of[asking[n]], world.itinerary_objects[world.at[asking[n]]]
        _arrive(world, clocks, me, departs[n])
        size = world.object_bytes[wanted]
        clocks[me] += world.receive_ps + _copy_ps(world.unpack, OBJECT, size)
        _test_all(world, step, asking[n : n + 1])


@njit
def ray_step(world: World, step: Step, alive: Rays, missing: NDArray[np.bool_]) -> None:
    """Send one message to every other PE, receive one from each, test the rays that are here."""
    clocks, nb = step.clocks, step.clocks.size
    departs = np.zeros((nb, nb), np.int64)
    for me in range(nb):
        for away in range(1, nb):
            to = (me + away) % nb
            size = step.r[me, to] * world.ray_bytes
            clocks[me] += world.send_ps + _copy_ps(world.pack, RAYS, size)
            departs[me, to] = clocks[me]
    _test_all(world, step, alive[~missing])
    for me in range(nb):
        for away in range(1, nb):
            source = (me - away) % nb
            _arrive(world, clocks, me, departs[source, me])
            size = step.r[source, me] * world.ray_bytes
            clocks[me] += world.receive_ps + _copy_ps(world.unpack, RAYS, size)
    moving = alive[missing]
    for ray in moving:
        world.pe_of[ray] = world.owners[world.itinerary_objects[world.at[ray]]]
    _test_all(world, step, moving)


@kernel
def _arrive(world: World, clocks: Clocks, me: int, depart_ps: int) -> None:
    """Wait for a message that has not been sent yet."""
    if world.waits:
        clocks[me] = max(clocks[me], depart_ps)


@kernel
def _copy_ps(costs: NDArray[np.int64], kind: int, n_bytes: int) -> int:
    return costs[kind, 0] + transfer_ps(n_bytes, costs[kind, 1])


@kernel
def _test_all(world: World, step: Step, rays: Rays) -> None:
    """One test of each of these rays, where they are; a ray without itinerary has none."""
    for ray in rays:
        me = world.pe_of[ray]
        end = world.itinerary_offsets[ray + 1]
        if world.at[ray] < end:
            step.clocks[me] += world.test_ps[world.itinerary_objects[world.at[ray]]]
            step.tests[me] += 1
            world.at[ray] += 1
        if world.at[ray] == end:
            step.clocks[me] += world.ray_ps
            step.ended[me] += 1


@njit
def next_rays(world: World, alive: Rays) -> Rays:
    """Rays that go on, and the children of those that ended, on the PE where they ended."""
    n = 0
    for ray in alive:
        ended = world.at[ray] == world.itinerary_offsets[ray + 1]
        n += world.child_offsets[ray + 1] - world.child_offsets[ray] if ended else 1
    following = np.empty(n, np.int32)
    n = 0
    for ray in alive:
        if world.at[ray] < world.itinerary_offsets[ray + 1]:
            following[n] = ray
            n += 1
            continue
        for child in range(world.child_offsets[ray], world.child_offsets[ray + 1]):
            world.pe_of[child] = world.pe_of[ray]
            following[n] = child
            n += 1
    return following
