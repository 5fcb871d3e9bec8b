"""The rays of patches as a workload: each starts at its patch, each step of shooting is a round."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.radiosity.gathering import Gathering
from simmpp.workload.radiosity.room import Room
from simmpp.workload.radiosity.settings import GATHERING
from simmpp.workload.radiosity.shooting import UNIT_W, Shooting
from simmpp.workload.room import Recorded
from simmpp.workload.threads import mapping
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.generations import Spawning
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.trace.tracer import Made, Progress, Tracing, recorded, workload_of
from simmpp.workload.workload import Workload

OF_COUNT, OF_POWER = 8, 96
"""Bytes of a patch's results: a count for each patch that it sees; or the power of both its sides,
and what of it is unshot, in three colours."""
Hits = NDArray[np.int32]
Trace = Callable[[RayBatch], list[Recorded]]


def trace_patches(
    room: Room, progress: Progress | None = None, threads: int | None = None
) -> Workload:
    """All rays that patches send out, with their hits and itineraries.

    Raises
    ------
    SceneError
        Light would never end.
    ConfigError
        There are more rays than can be numbered or held.
    """
    rules = Spawning(np.zeros((0, 3)), reflection=False, refraction=False, max_depth=1)
    tracing = Tracing(room.geometry, Intersector(room.geometry), rules, room.name)
    if room.settings.method != GATHERING:  # shots are too small to be worth a thread
        return _shot(room, lambda rays: recorded(tracing, rays, map), progress)
    with mapping(threads) as run:
        return _gathered(room, lambda rays: recorded(tracing, rays, run, progress))


def _gathered(room: Room, trace: Trace) -> Workload:
    """One round: the rays of all sides that light reaches."""
    gathering, n = Gathering(room), room.n_sides // 2
    batches, homes = list[Recorded](), list[Hits]()
    while (rays := gathering.rays()) is not None:
        batch = trace(rays)
        homes.append(gathering.homes)
        gathering.take(room.landed(rays, _hits(batch)))
        batches += batch
    sent, places = gathering.pairs
    gathering.require_end()
    pairs = np.unique((sent // 2 * n + places // 2)[places >= 0])
    return _workload(
        room,
        (len(sent), 1),
        batches,
        root_homes=np.concatenate(homes),
        object_results=OF_COUNT * np.bincount(pairs // n, minlength=n),
    )


def _shot(room: Room, trace: Trace, progress: Progress | None) -> Workload:
    """A round for each shot, until little enough is unshot."""
    shooting, n = Shooting(room), room.settings.rays
    batches, homes, weights = list[Recorded](), list[Hits](), list[NDArray[np.float64]]()
    residuals = list[float]()
    while (rays := shooting.rays()) is not None:
        batch = trace(rays)
        homes.append(shooting.homes)
        weights.append(shooting.powers.sum(axis=1) * UNIT_W)
        shooting.take(room.landed(rays, _hits(batch)))
        residuals.append(float(shooting.residual))
        batches += batch
        if progress:
            progress(n * len(homes), n * (len(homes) + 1))
    return _workload(
        room,
        (len(homes), n),
        batches,
        root_homes=np.concatenate(homes),
        root_rounds=np.repeat(np.arange(len(homes), dtype=np.int32), n),
        root_weights=np.concatenate(weights),
        round_residuals=np.array(residuals),
        object_results=np.full(room.n_sides // 2, OF_POWER),
    )


def _hits(batches: list[Recorded]) -> Hits:
    return np.concatenate([batch.hits for batch in batches])


def _workload(
    room: Room, shape: tuple[int, int], batches: list[Recorded], **extras: NDArray[np.generic]
) -> Workload:
    made = Made(room.name, room.digest, shape)
    return workload_of(room.patches.scene, made, room.geometry, room.frame, batches, **extras)


def task_of(room: Room) -> Gathering | Shooting:
    """What the settings ask for, from its beginning."""
    return Gathering(room) if room.settings.method == GATHERING else Shooting(room)


def again(
    room: Room, workload: Workload, done: NDArray[np.bool_] | None = None
) -> tuple[Gathering | Shooting, list[RayBatch]]:
    """What comes of the recorded hits, of the ``done`` roots (n0,) if given; and the rays."""
    task, batches, first = task_of(room), list[RayBatch](), 0
    while (rays := task.rays()) is not None:
        batches.append(rays)
        recorded_ones = slice(first, first + len(rays.kinds))
        first = recorded_ones.stop
        places = room.landed(rays, workload.hits[recorded_ones].copy())
        task.take(places, None if done is None else done[recorded_ones])
    return task, batches
