"""Draws the pictures of each run of a point as soon as it is over."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.policy.parameters import PolicyParameters
from simmpp.report.run_figures.data import motion_of
from simmpp.run.point import Point, PolicyRun
from simmpp.workload.trace.shading import render

MOST_DRAWN_PES = 2048


class FiguresRecorder:
    """Writes <policy>-<what>.png and .svg into a folder."""

    needs_counters = True

    def __init__(self, folder: Path, point: Point) -> None:
        if point.machine.processors > MOST_DRAWN_PES:
            problem = f"expected at most {MOST_DRAWN_PES} processors: who sent to whom is a matrix"
            raise ConfigError(problem, where="--figures")
        self._folder = folder
        self._point = point
        self._picture = _picture(point)

    def begin(self, policy: PolicyParameters) -> None:
        """Ask for no event log: the counters of a run are enough for its pictures."""

    def end(self, run: PolicyRun) -> None:
        """A run is over: draw it."""
        from simmpp.report.run_figures.drawing import draw_motion

        draw_motion(motion_of(self._point, run), self._folder, self._picture)


def _picture(point: Point) -> NDArray[np.uint8] | None:
    """What was rendered, if there is a scene and not only its rays."""
    load_scene = point.config.ray_source.scene
    return load_scene and render(load_scene(), point.config.picture, point.workload)
