"""Do real rays do what the map of random ones says?

    python experiments/machines/real_scenes.py

A terrain of 65,522 triangles in clusters of 1 to 512, pixels dealt in blocks or one by one, on the
machines of ``dataflow_map.py`` (160 x 160 or 480 x 480 pixels, shadows and all; PEs own their share
and keep what they fetch). Rays per fetch and bytes are counted: uses of objects on PEs that do not
own them, by the pairs of such a PE and object. Writes real_scenes.csv: T(object) / T(ray) of each,
and that of the nearest point of the map, which has to be there.
"""

from __future__ import annotations

import csv
import math
import sys
import tempfile
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from simmpp.common.files import write_csv
from simmpp.engine.simulate import simulate
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.workload import Workload

sys.path.append(str(Path(__file__).parent))

from dataflow_map import SEED, machines

HERE = Path(__file__).parent
SIDE = 182
"""Vertices along each side."""
CASES = ((1, 160), (8, 160), (64, 160), (512, 160), (64, 480), (512, 480))
"""Triangles of a cluster at most, and pixels along each side."""
PIXELS: tuple[Any, ...] = ("blocks", "interleaved")

Row = dict[str, Any]


def terrain() -> str:
    """Hills as OBJ."""
    x, z = np.meshgrid(np.linspace(0, 8, SIDE), np.linspace(0, 8, SIDE))
    waves = ((0.9, 1.1, 0.7), (2.3, 1.9, 0.3), (5.1, 4.7, 0.12))
    y = np.zeros_like(x)
    for a, b, height in waves:
        y += height * np.sin(a * x) * np.cos(b * z)
    lines = [
        f"v {vx:.6f} {vy:.6f} {vz:.6f}" for vx, vy, vz in zip(x.flat, y.flat, z.flat, strict=True)
    ]
    for row in range(SIDE - 1):
        for column in range(SIDE - 1):
            a = row * SIDE + column + 1
            lines += [f"f {a} {a + SIDE} {a + 1}", f"f {a + 1} {a + SIDE} {a + SIDE + 1}"]
    return "\n".join(lines) + "\n"


def rays_per_fetch(workload: Workload, placement: Placement) -> tuple[float, float]:
    """How often a PE uses an object of another one, and the mean bytes of those."""
    lengths = np.diff(workload.itinerary_offsets)
    pes = np.repeat(placement.pixel_pes[workload.pixels].astype(np.int64), lengths)
    objects = workload.itinerary_objects
    foreign = placement.owners[objects] != pes
    fetched = np.unique(pes[foreign] * workload.n_objects + objects[foreign])
    n_bytes = workload.object_bytes[fetched % workload.n_objects].mean()
    return foreign.sum() / len(fetched), float(n_bytes)


def nearest(points: list[Row], name: str, n_bytes: float, uses: float) -> Row:
    """The point of a machine's map that is nearest in logarithms."""

    def distance(point: Row) -> float:
        across = math.log(float(point["bytes"]) / n_bytes)
        return math.hypot(across, math.log(float(point["rays_per_fetch"]) / uses))

    return min((point for point in points if point["machine"] == name), key=distance)


def simulated(points: list[Row]) -> Iterator[Row]:
    """Each cut, dealing of pixels and machine."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "terrain.obj"
        path.write_text(terrain())
        for most, side in CASES:
            workload = workload_for(load_scene(f"{path}:{most}"), Picture(resolution=side))
            for pixels in PIXELS:
                for name, made in machines().items():
                    memory = Memory(Fraction(0), transient=workload.n_objects)
                    rules = PlacementRules(pixels=pixels)
                    placement = place(workload, made.processors, memory, rules, SEED)
                    uses, n_bytes = rays_per_fetch(workload, placement)
                    object_ps, ray_ps = (
                        simulate(workload, made, placement, PolicyParameters(policy)).makespan_ps
                        for policy in ("object", "ray")
                    )
                    there = nearest(points, name, n_bytes, uses)
                    yield {
                        "machine": name,
                        "triangles": most,
                        "resolution": side,
                        "pixels": pixels,
                        "bytes": round(n_bytes),
                        "rays_per_fetch": float(f"{uses:.3g}"),
                        "object_over_ray": float(f"{object_ps / ray_ps:.3g}"),
                        "map": float(f"{int(there['object_ps']) / int(there['ray_ps']):.3g}"),
                    }


def main() -> None:
    """Simulate, write rows, say how often both agree."""
    with open(HERE / "dataflow_map.csv", encoding="utf-8", newline="") as file:
        rows = list(simulated(list(csv.DictReader(file))))
    write_csv(rows, list(rows[0]), HERE / "real_scenes.csv")
    for row in rows:
        print(*row.values(), sep=" | ")
    agreed = sum((row["object_over_ray"] < 1) == (row["map"] < 1) for row in rows)
    print(f"the same dataflow is the faster in {agreed} of {len(rows)}")


if __name__ == "__main__":
    main()
