"""The rays of a workload, recomputed from its hits: a workload stores what they meet, not them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from simmpp.errors import WorkloadError
from simmpp.scene.scene import Scene
from simmpp.workload.digest import digest_of
from simmpp.workload.geometry import Geometry, flatten
from simmpp.workload.normalise import Frame, frame_of
from simmpp.workload.picture import Picture
from simmpp.workload.rays import Rays, children, first_generation, spawning
from simmpp.workload.workload import Workload


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
    if workload.digest != digest_of(scene, picture):
        raise WorkloadError("the workload is of another scene or picture", where=workload.name)
    frame = frame_of(scene)
    return Traced(scene, picture, workload, frame, flatten(scene, frame))


def generations(traced: Traced) -> Iterator[tuple[int, Rays]]:
    """The number of the first ray, and the rays, of each depth, from the recorded hits.

    Raises
    ------
    WorkloadError
        The recorded hits do not spawn the recorded rays.
    """
    scene, picture, workload, frame, geometry = traced
    rules = spawning(scene, picture, frame, geometry)
    rays, start, depth = first_generation(scene, picture, frame), 0, 1
    while len(rays.kinds):
        stop = start + len(rays.kinds)
        same_kinds = np.array_equal(rays.kinds, workload.kinds[start:stop])
        if not (same_kinds and np.array_equal(rays.parents, workload.parents[start:stop])):
            raise WorkloadError(f"its hits spawn other rays at depth {depth}", where=workload.name)
        yield start, rays
        distances = workload.hit_distances[start:stop] * frame.scale
        rays, _ = children(
            geometry, rays, workload.hits[start:stop].copy(), distances, rules, depth, start
        )
        start, depth = stop, depth + 1
    if start != workload.n_rays:
        problem = f"it records {workload.n_rays} rays, its hits spawn {start}"
        raise WorkloadError(problem, where=workload.name)
