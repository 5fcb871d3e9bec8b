"""The rays of a workload, recomputed from its hits: a workload stores what they meet, not them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from simmpp.common.errors import WorkloadError
from simmpp.scene.scene import Scene
from simmpp.workload.digest import digest_of
from simmpp.workload.picture import Picture
from simmpp.workload.trace.frame import Frame, frame_of
from simmpp.workload.trace.generations import children, first_generation, spawning
from simmpp.workload.trace.geometry import Geometry, flatten
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.workload import Workload


class SpawnError(WorkloadError):
    """Recorded hits do not spawn the recorded rays."""

    def __init__(self, ray: int, name: str) -> None:
        super().__init__(f"the recorded hit of ray {ray} spawns other rays", where=name)
        self.ray = ray


class Traced(NamedTuple):
    """A scene as it was traced, and what was recorded."""

    scene: Scene
    picture: Picture
    workload: Workload
    frame: Frame
    geometry: Geometry


def traced(scene: Scene, picture: Picture, workload: Workload) -> Traced:
    """Put ``workload`` beside the geometry that it was made of.

    Raises
    ------
    WorkloadError
        It was made of another scene or picture.
    """
    picture = picture.of(scene)
    if workload.digest != digest_of(scene, picture):
        raise WorkloadError("the workload is of another scene or picture", where=workload.name)
    frame = frame_of(scene)
    return Traced(scene, picture, workload, frame, flatten(scene, frame))


def recorded_generations(traced: Traced) -> Iterator[tuple[int, RayBatch]]:
    """The number of the first ray, and the rays, of each depth, from the recorded hits.

    Raises
    ------
    SpawnError
        The recorded hits do not spawn the recorded rays.
    """
    scene, picture, workload, frame, geometry = traced
    rules = spawning(scene, picture, frame, geometry)
    rays, start, depth = first_generation(scene, picture, frame), 0, 1
    while len(rays.kinds):
        stop = start + len(rays.kinds)
        _compare(rays, start, workload)
        yield start, rays
        distances = workload.hit_distances[start:stop] * frame.scale
        # Copies of the workload's pages, which are read-only: another type to compiled code.
        rays, _ = children(
            geometry, rays, workload.hits[start:stop].copy(), distances, rules, depth, start
        )
        start, depth = stop, depth + 1
    if start != workload.n_rays:
        raise SpawnError(int(workload.parents[start]), workload.name)


def _compare(rays: RayBatch, start: int, workload: Workload) -> None:
    """Raise SpawnError for the first ray whose children are not the recorded ones."""
    recorded = slice(start, start + len(rays.kinds))
    kinds, parents = workload.kinds[recorded], workload.parents[recorded]
    n_recorded = len(kinds)
    same = (kinds == rays.kinds[:n_recorded]) & (parents == rays.parents[:n_recorded])
    if not same.all():
        first = int(same.argmin())
        raise SpawnError(max(0, min(int(parents[first]), int(rays.parents[first]))), workload.name)
    if n_recorded < len(rays.kinds):
        raise SpawnError(max(0, int(rays.parents[n_recorded])), workload.name)
