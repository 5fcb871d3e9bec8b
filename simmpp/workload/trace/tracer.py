"""Traces a picture into a workload: generation by generation, in batches of rays."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import njit
from simmpp.common.validate import require_kind
from simmpp.scene.boxes import boxes_of
from simmpp.scene.check import check_scene
from simmpp.scene.columns import columns_of
from simmpp.scene.scene import Scene
from simmpp.scene.wire import sizes_on_the_wire
from simmpp.workload.digest import digest_of
from simmpp.workload.picture import PATH, Picture
from simmpp.workload.room import (
    Recorded,
    few_roots,
    require_memory,
    require_numbers,
    require_room,
)
from simmpp.workload.threads import Run, mapping
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.frame import Frame, frame_of
from simmpp.workload.trace.generations import Rules, children, first_generation, spawning
from simmpp.workload.trace.geometry import Geometry, flatten
from simmpp.workload.trace.itineraries import find_itineraries
from simmpp.workload.trace.path.generations import drawn_rays
from simmpp.workload.trace.ray_batch import RayBatch, joined
from simmpp.workload.workload import SHADOW, Workload, frozen

BATCH = 65536
"""Rays of one batch: bounds the memory of what is only passing through."""
Number = TypeVar("Number", bound=np.generic)
Progress = Callable[[int, int], None]
"""Is told the rays done and the rays known so far."""


class Tracing(NamedTuple):
    """What all batches of a picture read."""

    geometry: Geometry
    proposer: Intersector
    rules: Rules
    name: str
    """The scene's, for errors."""


class Made(NamedTuple):
    """What a workload is called, and the shape of its primary rays."""

    name: str
    digest: str
    shape: tuple[int, int]
    """Rows and columns."""
    passes: int = 1


def trace(
    scene: Scene,
    picture: Picture,
    progress: Progress | None = None,
    intersector: Callable[[Geometry], Intersector] = Intersector,
    threads: int | None = None,
) -> Workload:
    """All rays of ``picture`` with their hits and itineraries.

    Parameters
    ----------
    progress : called after each batch with the rays done and the rays known so far
    intersector : makes the proposals; the workload does not depend on them
    threads : None for as many as there are cores; the workload does not depend on them

    Raises
    ------
    SceneError
        The scene's geometry or camera can't be traced.
    ConfigError
        The picture has more than MOST_RAYS rays, or more than the machine's memory holds.
    """
    require_kind("scene", scene, Scene)
    require_kind("picture", picture, Picture)
    check_scene(scene)
    picture = picture.of(scene)
    require_numbers(picture.n_roots, scene.name)
    require_memory(picture.n_roots, scene.name)
    frame = frame_of(scene)
    geometry = flatten(scene, frame)
    rules = spawning(scene, picture, frame, geometry)
    tracing = Tracing(geometry, intersector(geometry), rules, scene.name)
    if picture.render == PATH:
        rays = drawn_rays(scene, picture, frame, few_roots(picture.n_roots))
        require_room(picture.n_roots, recorded(tracing, rays, map), scene.name)
    rays = first_generation(scene, picture, frame)
    with mapping(threads) as run:
        batches = recorded(tracing, rays, run, progress)
    del rays
    made = Made(scene.name, digest_of(scene, picture), picture.shape, picture.passes)
    return workload_of(scene, made, geometry, frame, batches)


def recorded(
    tracing: Tracing, rays: RayBatch, run: Run, progress: Progress | None = None
) -> list[Recorded]:
    """What is recorded of ``rays`` and of all that they spawn, generation by generation."""
    batches: list[Recorded] = []
    start = depth = 0
    while len(rays.kinds):
        depth += 1
        known = end = start + len(rays.kinds)
        lows = range(start, end, BATCH)
        parts = [rays.part(low - start, low - start + BATCH) for low in lows]
        work = partial(_of_batch, tracing, depth)
        spawned = []
        # Where there is one batch only, no other thread has anything to do.
        for low, (batch, young) in zip(
            lows, (run if len(parts) > 1 else map)(work, parts, lows), strict=True
        ):
            spawned.append(young)
            batches.append(batch)
            known += len(young.kinds)
            require_numbers(known, tracing.name)
            if progress:
                progress(low + len(batch.kinds), known)
        del parts
        start, rays = end, joined(spawned)
    return batches


def _of_batch(tracing: Tracing, depth: int, rays: RayBatch, low: int) -> tuple[Recorded, RayBatch]:
    """A batch whose first ray has number ``low``, and the rays that it spawns."""
    geometry, proposer, rules, _ = tracing
    hits, distances, n_tests, objects = _intersected(geometry, proposer, rays)
    young, n_children = children(geometry, rays, hits, distances, rules, depth, low)
    recorded = rays.kinds, rays.parents, n_children, hits, distances, n_tests, objects
    return Recorded(*recorded), young


def _intersected(
    geometry: Geometry, proposer: Intersector, rays: RayBatch
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """Hits, normalised distances, lengths of the itineraries, and the itineraries of a batch."""
    claims = np.full((len(rays.kinds), 2), -1, dtype=np.int32)
    # The nearest hit of a shadow ray is no bound: its first blocker by entry may lie behind it.
    asks = rays.kinds != SHADOW
    claims[asks] = proposer.claims(rays.origins[asks], rays.directions[asks])
    return find_itineraries(geometry.shapes, rays, claims)


def workload_of(
    scene: Scene,
    made: Made,
    geometry: Geometry,
    frame: Frame,
    batches: list[Recorded],
    **extras: NDArray[Any],
) -> Workload:
    """The workload of all ``batches``, which are used up; ``extras`` are optional arrays of it."""
    lists: list[list[Any]] = [list(column) for column in zip(*batches, strict=True)]
    batches.clear()  # so that _emptied frees what it has copied
    kinds, parents, n_children, hits, distances, n_tests, itineraries = map(_emptied, lists)
    objects = columns_of(scene)
    bounds, n_roots = boxes_of(objects, frame.origin), made.shape[0] * made.shape[1] * made.passes
    return frozen(
        Workload(
            name=made.name,
            digest=made.digest,
            picture=made.shape,
            kinds=kinds,
            parents=parents,
            child_offsets=np.cumsum(np.insert(n_children, 0, n_roots), dtype=np.int32),
            pixels=pixels_of(parents),
            hits=hits,
            hit_distances=frame.scene_lengths(distances),
            # int64, since the tests of 2^31 rays may be more than 2^31.
            itinerary_offsets=np.cumsum(np.insert(n_tests, 0, 0), dtype=np.int64),
            itinerary_objects=itineraries,
            object_kinds=geometry.kinds,
            object_triangles=geometry.n_triangles,
            object_bytes=sizes_on_the_wire(objects),
            object_centroids=frame.rounded(bounds.mean(axis=1)),
            samples=made.passes,
            **extras,
        )
    )


def _emptied(parts: list[NDArray[Number]]) -> NDArray[Number]:
    """All parts, one after the other; the list is left empty, so they are not held twice."""
    whole = np.empty(sum(map(len, parts)), parts[0].dtype)
    end = len(whole)
    while parts:
        part = parts.pop()
        whole[end - len(part) : end] = part
        end -= len(part)
    return whole


@njit
def pixels_of(parents: NDArray[np.int32]) -> NDArray[np.int32]:
    """The primary ray at the root of each ray's tree, (n,) int32."""
    pixels = np.empty(len(parents), np.int32)
    for i in range(len(parents)):  # a parent has the lower number: its pixel is known
        pixels[i] = i if parents[i] < 0 else pixels[parents[i]]
    return pixels
