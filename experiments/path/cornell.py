"""The Cornell box by the tracer's paths and by Mitsuba's: writes cornell.csv and cornell.png.

    python experiments/path/cornell.py [BATCHES, default 32]

A picture of 128 x 128 pixels, its light in 4 x 4 patches, 8,192 paths of depth 8 in each patch and
batch; each batch has a seed of its own. The standard error of the difference is that of the means
of batches.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import simmpp
from simmpp.common.files import write_csv
from simmpp.config.config import load_config
from simmpp.scene.scene import Scene
from simmpp.workload.sources import scene_of
from simmpp.workload.trace.shading import in_bytes, light, save_png

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.mitsuba_paths import MitsubaPaths

HERE = Path(__file__).parent
SIDE, PATCHES, SAMPLES, DEPTH = 128, 4, 8, 8
Floats = NDArray[np.float64]


def box() -> Scene:
    """The scene of cornell.yaml."""
    return scene_of(load_config(HERE / "cornell.yaml").ray_source, "scene")()


def pictures(scene: Scene, seed: int, side: int, samples: int) -> tuple[Floats, Floats]:
    """(side, side, 3) of the tracer and of Mitsuba."""
    picture = simmpp.Picture(
        resolution=side, render="path", samples=samples, depth=DEPTH, seed=seed
    )
    ours = light(scene, picture, simmpp.trace(scene, picture))
    return ours, MitsubaPaths(scene).light((side, side), samples, DEPTH, seed)


def patches(image: Floats) -> Floats:
    """Means of (PATCHES, PATCHES, 3) patches."""
    size = len(image) // PATCHES
    means: Floats = image.reshape(PATCHES, size, PATCHES, size, 3).mean(axis=(1, 3))
    return means


def main() -> None:
    """Print and write a row per patch and colour."""
    scene, n = box(), int(sys.argv[1]) if len(sys.argv) > 1 else 32
    both = [pictures(scene, seed, SIDE, SAMPLES) for seed in range(n)]
    ours, theirs = (np.array([patches(pair[k]) for pair in both]) for k in (0, 1))
    mean, other = ours.mean(axis=0), theirs.mean(axis=0)
    error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / n)
    off, z = mean / other - 1, (mean - other) / error
    rows = [
        {
            "row": row,
            "column": column,
            "colour": colour,
            "simmpp": f"{mean[row, column, k]:.5f}",
            "mitsuba": f"{other[row, column, k]:.5f}",
            "difference": f"{off[row, column, k]:+.3%}",
            "standard_errors": f"{z[row, column, k]:+.2f}",
        }
        for row in range(PATCHES)
        for column in range(PATCHES)
        for k, colour in enumerate(("red", "green", "blue"))
    ]
    write_csv(rows, list(rows[0]), HERE / "cornell.csv")
    print(f"largest difference {np.abs(off).max():.2%}, chi-square {(z**2).sum():.1f} of {z.size}")
    beside = np.hstack([np.mean([pair[k] for pair in both], axis=0) for k in (0, 1)])
    save_png(in_bytes(np.sqrt(beside)), HERE / "cornell.png")


if __name__ == "__main__":
    main()
