"""Where the time and memory of a trace go: python tests/bench/bench_trace.py [--path] [SCENE ...]

Prints stage, seconds of CPU, share, and the whole in multiples of what embree alone needs for the
nearest hits of the same rays. Whitted's rays at 512 x 512, or 16 paths a pixel at 128 x 128; `room`
is a closed room. One thread. Asserts nothing.
"""

from __future__ import annotations

import dataclasses
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))  # tests/
from path_scenes import room

from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.frame import frame_of
from simmpp.workload.trace.generations import children, first_generation, spawning
from simmpp.workload.trace.geometry import Geometry, flatten
from simmpp.workload.trace.itineraries import find_itineraries
from simmpp.workload.trace.ray_batch import RayBatch, joined
from simmpp.workload.trace.tracer import BATCH, trace
from simmpp.workload.workload import SHADOW

REPEATS = 3


class Stages:
    """Seconds by name."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def time(self, name: str, work: Callable, *args):
        start = time.process_time()
        result = work(*args)
        self.seconds[name] = self.seconds.get(name, 0.0) + time.process_time() - start
        return result


def stages_of(scene: Scene, picture: Picture) -> Stages:
    stages = Stages()
    frame = stages.time("frame", frame_of, scene)
    geometry = stages.time("geometry and trees", flatten, scene, frame)
    proposer = stages.time("embree: build", Intersector, geometry)
    rules = spawning(scene, picture, frame, geometry)
    rays = stages.time("primary rays", first_generation, scene, picture, frame)
    depth = 0
    while len(rays.kinds):
        depth += 1
        spawned = [
            batch(stages, geometry, proposer, rules, rays.part(low, low + BATCH), depth)
            for low in range(0, len(rays.kinds), BATCH)
        ]
        rays = stages.time("joining", joined, spawned)
    return stages


def batch(stages, geometry: Geometry, proposer: Intersector, rules, rays: RayBatch, depth: int):
    asks = rays.kinds != SHADOW
    claims = np.full((len(asks), 2), -1, dtype=np.int32)
    some = rays.origins[asks], rays.directions[asks]
    claims[asks] = stages.time("embree: proposals", proposer.claims, *some)
    others = rays.origins[~asks], rays.directions[~asks]
    stages.time("(embree: shadow rays, not needed)", proposer.claims, *others)
    hits, distances, _, _ = stages.time(
        "itineraries and hits",
        find_itineraries,
        geometry.shapes,
        rays,
        claims,
    )
    young, _ = stages.time("spawning", children, geometry, rays, hits, distances, rules, depth, 0)
    return young


def main() -> None:
    names = [name for name in sys.argv[1:] if name != "--path"]
    picture = Picture(resolution=128, render="path", samples=16)
    if "--path" not in sys.argv:
        picture = Picture()
    for name in names or ["mountain:5"]:
        scene = room() if name == "room" else load_scene(name)
        trace(scene, dataclasses.replace(picture, resolution=32))  # compiles
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        seconds = []
        for _ in range(REPEATS):
            start = time.process_time()
            workload = trace(scene, picture, threads=1)
            seconds.append(time.process_time() - start)
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        best = min(
            (stages_of(scene, picture) for _ in range(REPEATS)),
            key=lambda s: sum(s.seconds.values()),
        )
        counts = np.bincount(workload.kinds, minlength=4)
        print(
            f"{name}: {workload.n_objects} objects, {workload.n_rays} rays {counts}, "
            f"{workload.n_tests} tests"
        )
        whole = sum(best.seconds.values())
        for stage, spent in best.seconds.items():
            print(f"  {stage:<36}{spent:8.3f} s {spent / whole:6.1%}")
        embree = sum(best.seconds[s] for s in best.seconds if "proposals" in s or "shadow" in s)
        print(
            f"  trace {min(seconds):.3f} s = {min(seconds) / embree:.1f} x embree's {embree:.3f} s"
        )
        print(f"  memory at the peak {peak * 1024 / workload.n_rays:.0f} bytes per ray")


if __name__ == "__main__":
    main()
