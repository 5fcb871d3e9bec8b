"""The simulations behind rungs.py: kept in rungs-runs.csv, made where they are missing.

A kind is a way to simulate one seed of a scene's curve: in full, with the residents of the rung
``curve``, or cheaper. Each row is one run; cpu_s is of this process, without tracing and placement.
"""

from __future__ import annotations

import csv
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from simmpp.engine.simulate import simulate
from simmpp.machine.presets import machine
from simmpp.placement.place import place, rotated
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.studies.curve.estimate import node_fractions
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.workload import Workload, frozen

FILE = Path(__file__).with_name("rungs-runs.csv")
COLUMNS = ["kind", "scene", "fraction", "seed", "policy", "makespan_ps", "messages", "cpu_s"]
FIGURE4 = ("mountain:5", "rings:1", "tetra:5", "tetra:6")
HELD_OUT = {"balls:3": 32, "gears:3": 16, "jacks:3": 48, "lattice:6": 128}
"""Scenes that nothing was chosen on, with numbers of PEs; 256 x 256."""
TEXTS = "1/64 3/100 1/20 1/10 3/20 1/5 3/10 2/5 1/2 3/5 7/10 4/5 9/10"
GRID = [Fraction(x) for x in TEXTS.split()]
"""Figure 4's, without 1, where every profit is 1."""
POLICIES = ("object", "concurrent", "ray")


@dataclass(frozen=True)
class Kind:
    """How one seed is simulated."""

    name: str
    seeds: range
    held_out_seeds: range = range(0)
    pixels: float = 1.0
    """Resolution relative to the full one."""
    quantum: int = 64
    part: Fraction = Fraction(1)
    """Of the pixels of each PE, the first ones."""
    together: bool = False
    """Residents by ``rotated``, at the nodes of the rung ``curve``."""


KINDS = (
    Kind("full", range(27), range(12)),
    Kind("curve", range(100, 124), range(100, 108), together=True),
    Kind("pixels / 4", range(2), pixels=1 / 2),
    Kind("pixels / 16", range(27), pixels=1 / 4),
    Kind("half of the rays", range(1), part=Fraction(1, 2)),
    Kind("quarter of the rays", range(1), part=Fraction(1, 4)),
    Kind("quantum 256", range(1), quantum=256),
    Kind("quantum 1024", range(1), quantum=1024),
)


def processors_of(scene: str) -> int:
    """64 as in figure 4, or what the scene is held out with."""
    return HELD_OUT.get(scene, 64)


def fractions_of(kind: Kind, scene: str) -> list[Fraction]:
    """Where a kind is simulated."""
    grid = [max(x, Fraction(1, processors_of(scene))) for x in GRID]
    return node_fractions(min(grid)) if kind.together else sorted(set(grid))


def all_runs() -> list[dict[str, str]]:
    """Every row, made if need be."""
    known = _read()
    done = {(row["kind"], row["scene"], int(row["seed"])) for row in known}
    for scene in (*FIGURE4, *HELD_OUT):
        for kind in KINDS:
            seeds = kind.held_out_seeds if scene in HELD_OUT else kind.seeds
            for seed in seeds:
                if (kind.name, scene, seed) not in done:
                    _write(list(_run(kind, scene, seed)))
    return _read()


def _read() -> list[dict[str, str]]:
    if not FILE.exists():
        return []
    with open(FILE, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _write(rows: list[dict[str, object]]) -> None:
    new = not FILE.exists()
    with open(FILE, "a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        if new:
            writer.writeheader()
        writer.writerows(rows)
    print(*(rows[0][key] for key in ("kind", "scene", "seed")), flush=True)


def _run(kind: Kind, scene: str, seed: int) -> Iterator[dict[str, object]]:
    """All fractions and policies of one seed."""
    nb, size = processors_of(scene), 256 if scene in HELD_OUT else 512
    workload = workload_for(load_scene(scene), Picture(resolution=int(size * kind.pixels)))
    hardware = replace(machine("t3e", {}, nb), quantum=kind.quantum)
    for x, placement in _placements(kind, scene, workload, seed):
        rays, placed = part_of(workload, placement, kind.part)
        for policy in POLICIES:
            began = time.process_time()
            result = simulate(rays, hardware, placed, PolicyParameters(policy))
            cpu_s = round(time.process_time() - began, 4)
            numbers = (result.makespan_ps, result.messages, cpu_s)
            yield dict(zip(COLUMNS, (kind.name, scene, x, seed, policy, *numbers), strict=True))


def _placements(
    kind: Kind, scene: str, workload: Workload, seed: int
) -> Iterator[tuple[Fraction, Placement]]:
    nb, xs = processors_of(scene), fractions_of(kind, scene)
    if kind.together:
        yield from zip(xs, rotated(workload, nb, xs, PlacementRules(), seed), strict=True)
    else:
        for x in xs:
            yield x, place(workload, nb, Memory(x), PlacementRules(), seed)


def part_of(workload: Workload, placement: Placement, part: Fraction) -> tuple[Workload, Placement]:
    """The first pixels of each PE with all that descends from them."""
    if part == 1:
        return workload, placement
    pes = placement.pixel_pes
    rank = np.arange(len(pes)) - np.searchsorted(pes, pes)  # pixels in blocks: PEs in order
    chosen = rank < np.bincount(pes)[pes] * float(part)
    kept = chosen[workload.pixels]
    number = np.cumsum(kept) - 1
    children = np.diff(workload.child_offsets)[kept]
    lengths = np.diff(workload.itinerary_offsets)
    n0 = int(chosen.sum())
    parents = workload.parents[kept]
    smaller = replace(
        workload,
        picture=(1, n0),
        kinds=workload.kinds[kept],
        parents=np.where(parents < 0, -1, number[parents]).astype(np.int32),
        child_offsets=(n0 + np.concatenate([[0], np.cumsum(children)])).astype(np.int32),
        pixels=number[workload.pixels[kept]].astype(np.int32),
        hits=workload.hits[kept],
        hit_distances=workload.hit_distances[kept],
        itinerary_offsets=np.concatenate([[0], np.cumsum(lengths[kept])]).astype(np.int64),
        itinerary_objects=workload.itinerary_objects[np.repeat(kept, lengths)],
    )
    return frozen(smaller), replace(placement, pixel_pes=np.ascontiguousarray(pes[chosen]))


if __name__ == "__main__":
    print(len(all_runs()), "runs")
