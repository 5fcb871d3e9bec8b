"""The Cornell box by radiosity and by Mitsuba 3's path tracer: writes patches.csv and patches.png.

    python experiments/rays/patches.py [SEEDS, default 16]

Mitsuba's light is that of ../path/cornell.csv: paths of depth 8, so light after at most 7 bounces,
as here. The floor is cut along the blocks that stand on it: a patch that is half below a block is
dark there, and has one colour only.
"""

from __future__ import annotations

import csv
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray

import simmpp
from simmpp.common.files import write_csv
from simmpp.config.config import load_config
from simmpp.scene.scene import MeshPart, Scene
from simmpp.workload.radiosity.gathering import Gathering, brightness, form_factors
from simmpp.workload.radiosity.room import Room, room_of
from simmpp.workload.radiosity.settings import Radiosity
from simmpp.workload.radiosity.solution import seen
from simmpp.workload.sources import scene_of
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.shading import in_bytes, save_png

HERE = Path(__file__).parent
SETTINGS = Radiosity(patches=Fraction(3, 10_000), rays=1024)
VIEW = simmpp.Picture(
    resolution=1024, samples=4, max_depth=1, shadows=False, reflection=False, refraction=False
)
BOUNCES, PATCHES, BATCH = 7, 4, 2**18
COLOURS = ("red", "green", "blue")
Floats = NDArray[np.float64]


def box() -> Scene:
    """The scene of ../path/cornell.yaml, its floor cut."""
    path = HERE.parent / "path" / "cornell.yaml"
    scene = scene_of(load_config(path).ray_source, "scene")()
    floor, short, tall = (_part(scene, name) for name in ("floor", "short", "tall"))
    rings = [_corners(floor, 0), _corners(short, 0)[::-1], _corners(tall, 0)[::-1]]
    points = np.concatenate(rings)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    faces = mapbox_earcut.triangulate_float64(points[:, [2, 0]], ends).reshape(-1, 3)
    a, b, c = (points[faces[:, k]] for k in range(3))
    upright = np.cross(b - a, c - b)[:, 1] > 0
    faces[~upright] = faces[~upright, ::-1]
    cut = MeshPart(points, faces.astype(np.int32), floor.material, floor.name)
    return replace(scene, objects=tuple(cut if o is floor else o for o in scene.objects))


def _part(scene: Scene, name: str) -> MeshPart:
    return next(
        obj for obj in scene.objects if isinstance(obj, MeshPart) and obj.name.startswith(name)
    )


def _corners(part: MeshPart, height: float) -> Floats:
    """Where a part stands on the floor, round once."""
    points = np.unique(part.vertices[part.vertices[:, 1] == height], axis=0)
    ahead = points - points.mean(axis=0)
    found: Floats = points[np.argsort(np.arctan2(ahead[:, 0], ahead[:, 2]))]
    return found


def light_of(room: Room, proposer: Intersector) -> Floats:
    """Of each side, after as many bounces as Mitsuba's paths have.

    Embree's hits are enough here: nothing is recorded of the rays.
    """
    gathering = Gathering(room)
    while (rays := gathering.rays()) is not None:
        lows = range(0, len(rays.kinds), BATCH)
        parts = [rays.part(low, low + BATCH) for low in lows]
        claims = [proposer.claims(part.origins, part.directions)[:, 0] for part in parts]
        gathering.take(room.landed(rays, np.concatenate(claims).astype(np.int32)))
    factors = form_factors(room.n_sides, *gathering.pairs)
    emitted, reflectance = room.patches.emitted, room.patches.reflectance
    return brightness(factors, emitted.repeat(2, 0), reflectance.repeat(2, 0), BOUNCES)


def means(image: Floats) -> Floats:
    """Of (PATCHES, PATCHES, 3) patches of the picture."""
    size = len(image) // PATCHES
    return image.reshape(PATCHES, size, PATCHES, size, 3).mean(axis=(1, 3))


def mitsuba() -> Floats:
    """The same of Mitsuba's picture."""
    light = np.zeros((PATCHES, PATCHES, 3))
    with (HERE.parent / "path" / "cornell.csv").open() as file:
        for row in csv.DictReader(file):
            place = int(row["row"]), int(row["column"]), COLOURS.index(row["colour"])
            light[place] = float(row["mitsuba"])
    return light


def main() -> None:
    """Print and write a row per patch and colour."""
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 16
    room = room_of(box(), SETTINGS)
    proposer, lights = Intersector(room.geometry), []
    for seed in range(n):
        lights.append(light_of(room._replace(settings=replace(SETTINGS, seed=seed)), proposer))
        print(f"seed {seed}", flush=True)
    image, half = (seen(room, VIEW, np.mean(some, axis=0)) for some in (lights, lights[::2]))
    ours, theirs = means(image), mitsuba()
    off, noise = ours / theirs - 1, np.abs(means(half) / ours - 1)
    rows = [
        {
            "row": row,
            "column": column,
            "colour": colour,
            "radiosity": f"{ours[row, column, k]:.5f}",
            "mitsuba": f"{theirs[row, column, k]:.5f}",
            "difference": f"{off[row, column, k]:+.3%}",
        }
        for row in range(PATCHES)
        for column in range(PATCHES)
        for k, colour in enumerate(COLOURS)
    ]
    write_csv(rows, list(rows[0]), HERE / "patches.csv")
    print(np.round(100 * off[:, :, 1], 2))
    print(f"{room.n_sides // 2} patches: largest difference {np.abs(off).max():.2%}")
    print(f"half of the seeds alone: {noise.max():.2%} off the mean")
    save_png(in_bytes(np.sqrt(image[::2, ::2])), HERE / "patches.png")


if __name__ == "__main__":
    main()
