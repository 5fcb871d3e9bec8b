"""What changes in a workload when its scene is put into other units, elsewhere, or turned.

Powers of two and offsets that every coordinate bears change nothing (tests/stress); this is what
all others do, since they round the coordinates. Rays are compared along their trees: a ray is the
same ray as long as all its ancestors have spawned the same kinds of rays.

    python experiments/exactness/invariance.py      # invariance.csv beside it, 2 minutes
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

import simmpp
from simmpp.scene.scene import Scene
from simmpp.workload.workload import SHADOW, Workload

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from transforms import moved, scaled, turned

HERE = Path(__file__).parent
SCENES = ("mountain:4", "rings:1", "tetra:4", "gears:1", "balls:3")
PICTURE = simmpp.Picture(resolution=128)
PROCESSORS, FRACTION = 64, Fraction(1, 10)
DIRECTION = np.array([0.6, -0.48, 0.64])
"""Of the offsets; of length 1."""


def changes(scene: Scene, size: float) -> Iterator[tuple[str, str, Scene]]:
    """The scene in other units, elsewhere and turned; ``size`` is its diagonal."""
    for power in (-40, 40):
        yield "scaled by", f"2^{power}", scaled(scene, 2.0**power)
    for exponent in (-6, -3, 3, 6):
        yield "scaled by", f"1e{exponent}", scaled(scene, 10.0**exponent)
    for exponent in (0, 1, 2, 3, 4, 5, 6):
        offset = 10.0**exponent * size * DIRECTION
        yield "moved by (sizes)", f"1e{exponent}", moved(scene, tuple(offset.tolist()))
    for degrees in (90, 30):
        yield (
            "turned about z (degrees)",
            f"{degrees}",
            turned(scene, (0, 0, 1), math.radians(degrees)),
        )
    yield "turned about (1 2 3) (degrees)", "77", turned(scene, (1, 2, 3), math.radians(77))


def same_rays(here: Workload, there: Workload) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the same rays in both: (m,) int64 each."""
    mine = other = np.arange(here.n_primaries)
    found = [(mine, other)]
    while len(mine):
        pairs = [
            (np.arange(*here.child_offsets[i : i + 2]), np.arange(*there.child_offsets[j : j + 2]))
            for i, j in zip(mine, other, strict=True)
        ]
        pairs = [
            (a, b) for a, b in pairs if np.array_equal(here.kinds[a], there.kinds[b]) and len(a)
        ]
        mine, other = (
            np.concatenate([*side, np.zeros(0, np.int64)]).astype(np.int64)
            for side in (zip(*pairs, strict=True) if pairs else ((), ()))
        )
        found.append((mine, other))
    return tuple(np.concatenate(side) for side in zip(*found, strict=True))  # type: ignore[return-value]


def itineraries(workload: Workload) -> list[bytes]:
    """The objects of each ray, in order."""
    offsets = workload.itinerary_offsets
    return [workload.itinerary_objects[low:high].tobytes() for low, high in pairwise(offsets)]


def results(workload: Workload) -> list[simmpp.Result]:
    """Object and concurrent dataflow, seed 0."""
    machine = simmpp.make_machine("t3e", processors=PROCESSORS)
    memory = simmpp.Memory(fraction=FRACTION)
    placement = simmpp.place(workload, PROCESSORS, memory, simmpp.PlacementRules(), 0)
    policies = map(simmpp.PolicyParameters, ("object", "concurrent"))
    return [simmpp.simulate(workload, machine, placement, policy) for policy in policies]


def row(here: Workload, there: Workload, ratio: float, size: float) -> dict[str, object]:
    """How far ``there``, whose lengths are ``ratio`` times as large, differs from ``here``."""
    mine, other = same_rays(here, there)
    lists = itineraries(here), itineraries(there)
    same_hit = here.hits[mine] == there.hits[other]
    shadow = here.kinds[mine] == SHADOW
    same_tests = np.array(
        [lists[0][i] == lists[1][j] for i, j in zip(mine, other, strict=True)], dtype=bool
    )
    hit = same_hit & (here.hits[mine] >= 0) & ~shadow
    moved_by = np.abs(here.hit_distances[mine] - there.hit_distances[other] / ratio)[hit] / size
    objects, concurrents = zip(results(here), results(there), strict=True)
    owners = [
        simmpp.place(each, PROCESSORS, simmpp.Memory(), simmpp.PlacementRules(), 0).owners
        for each in (here, there)
    ]
    return {
        "rays": here.n_rays,
        "rays_there": there.n_rays,
        "rays_lost": here.n_rays - len(mine),
        "share_other_hit": f"{(~same_hit & ~shadow).sum() / here.n_rays:.6f}",
        "share_other_blocker": f"{(~same_hit & shadow).sum() / here.n_rays:.6f}",
        "share_other_itinerary": f"{1 - same_tests.sum() / here.n_rays:.6f}",
        "largest_move_of_a_hit_in_sizes": f"{moved_by.max():.1e}",
        "share_other_owner": f"{(owners[0] != owners[1]).mean():.4f}",
        "object_makespan_change": f"{objects[1].makespan_ps / objects[0].makespan_ps - 1:.1e}",
        "concurrent_makespan_change": (
            f"{concurrents[1].makespan_ps / concurrents[0].makespan_ps - 1:.1e}"
        ),
    }


def main() -> None:
    """Write invariance.csv."""
    rows = []
    for name in SCENES:
        scene = simmpp.load_scene(name)
        here = simmpp.trace(scene, PICTURE)
        low, high = (here.object_centroids.min(axis=0), here.object_centroids.max(axis=0))
        size = float(np.linalg.norm(high - low))
        for change, by, elsewhere in changes(scene, size):
            there = simmpp.trace(elsewhere, PICTURE)
            ratio = 2.0 ** float(by[2:]) if by.startswith("2^") else float(by)
            ratio = ratio if change == "scaled by" else 1.0
            rows.append(
                {"scene": name, "change": change, "by": by, **row(here, there, ratio, size)}
            )
            print(rows[-1], file=sys.stderr)
    pd.DataFrame(rows).to_csv(HERE / "invariance.csv", index=False, lineterminator="\n")


if __name__ == "__main__":
    main()
