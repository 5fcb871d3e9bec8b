"""Did the simulated PEs make what one processor makes? Asked of their tests by ``run --verify``."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np

from simmpp.commands.parts.terminal import FAILED, at_work, say
from simmpp.run.point import Point, PolicyRun
from simmpp.workload.describe import is_picture
from simmpp.workload.tallies import tally_of, tally_of_tests


def verify_runs(point: Point, runs: Sequence[PolicyRun], *, tallies: bool) -> None:
    """Say for each policy whether its PEs made the picture, and the ``tallies``; exit 1 unless all
    did."""
    source, failed = point.config.ray_source, False
    what = "the picture" if is_picture(point.workload) else "the result"
    nothing = np.zeros(0, np.int32)
    for run in runs:
        found = (run.result.tested_rays, run.result.tested_objects)
        rays, objects = (nothing if column is None else column for column in found)
        with at_work(f"verifying {run.parameters.title}"):
            problem = source.verify(point.config.picture, point.workload, rays, objects)
            if tallies and not problem:
                problem = wrong_tally(point, rays, objects)
        same = f"{what} of its tests is the same"
        if tallies:
            same += f", and so is what they leave in {point.workload.n_objects} objects"
        say(f"verify {run.parameters.title}: {f'differs: {problem}' if problem else same}")
        failed = failed or problem != ""
    if failed:
        sys.exit(FAILED)


def wrong_tally(
    point: Point, rays: np.ndarray[tuple[int], np.dtype[np.int32]], objects: np.ndarray
) -> str:
    """The first object in which tests have left something else; empty if there is none."""
    told, made = tally_of(point.workload), tally_of_tests(point.workload, rays, objects)
    for name, expected, got in zip(told._fields[:-1], told[:-1], made[:-1], strict=True):
        if len(wrong := np.flatnonzero(expected != got)):
            obj = int(wrong[0])
            return f"object {obj}: {name} {got[obj]}, expected {expected[obj]} (units of 2^-32)"
    return ""
