"""The Cornell box (published geometry) by the tracer's paths and by Mitsuba 3's path tracer.

The committed table of experiments/path/cornell.py has each patch within 1 % with 500 times as many
paths; here every patch is within 4 standard errors, and so is the whole.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from oracles.mitsuba_paths import MitsubaPaths

import simmpp
from simmpp.config.config import load_config
from simmpp.workload.sources import scene_of
from simmpp.workload.trace.shading import light

pytest.importorskip("mitsuba", reason="there are wheels for x86-64 only")

FOLDER = Path(__file__).parents[2] / "experiments" / "path"
SIDE, SAMPLES, DEPTH, BATCHES = 12, 8, 8, 8


def means(image: np.ndarray) -> np.ndarray:
    """Of 3 x 3 patches, and of the whole: (10, 3)."""
    of_patches = image.reshape(3, 4, 3, 4, 3).mean(axis=(1, 3)).reshape(9, 3)
    return np.vstack([of_patches, image.mean(axis=(0, 1))])


def test_the_cornell_box_is_mitsubas() -> None:
    scene = scene_of(load_config(FOLDER / "cornell.yaml").ray_source, "scene")()
    assert max(scene.background) == 0
    theirs = MitsubaPaths(scene)
    ours, others = [], []
    for seed in range(BATCHES):
        picture = simmpp.Picture(
            resolution=SIDE, render="path", samples=SAMPLES, depth=DEPTH, seed=seed
        )
        ours.append(means(light(scene, picture, simmpp.trace(scene, picture))))
        others.append(means(theirs.light((SIDE, SIDE), SAMPLES, DEPTH, seed)))
    one, other = np.array(ours), np.array(others)
    error = np.sqrt((one.var(axis=0, ddof=1) + other.var(axis=0, ddof=1)) / BATCHES)
    # 4 sigma of a normal mean; with 8 batches a side Student's t of 14 degrees allows 5.4.
    assert (np.abs(one.mean(axis=0) - other.mean(axis=0)) < 5.4 * error).all()
    assert (np.abs(one.mean(axis=0) / other.mean(axis=0) - 1)[-1] < 0.1).all()


def test_the_committed_table_is_within_one_per_cent() -> None:
    with (FOLDER / "cornell.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 48
    assert all(abs(float(row["difference"].rstrip("%"))) < 1 for row in rows)
