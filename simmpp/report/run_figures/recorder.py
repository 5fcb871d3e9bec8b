"""Has the pictures of each run of a point drawn as soon as it is over."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.policy.parameters import PolicyParameters
from simmpp.report.run_figures.data import Motion, motion_of
from simmpp.run.point import Point, PolicyRun

MOST_DRAWN_PES = 2048


class FiguresRecorder:
    """Has <policy>-<what>.png and .svg written into a folder, by whoever executes it."""

    needs_counters = True

    def __init__(self, folder: Path, point: Point, executor: Executor) -> None:
        if point.machine.processors > MOST_DRAWN_PES:
            problem = f"expected at most {MOST_DRAWN_PES} processors: who sent to whom is a matrix"
            raise ConfigError(problem, where="--figures")
        self._folder = folder
        self._point = point
        self._executor = executor
        self._picture = _picture(point)
        self.drawings: list[Future[list[Path]]] = []
        """One for each picture; the files that it became."""

    def begin(self, policy: PolicyParameters) -> None:
        """Ask for no event log: the counters of a run are enough for its pictures."""

    def end(self, run: PolicyRun) -> None:
        """A run is over: its pictures can be drawn."""
        motion = motion_of(self._point, run, self._picture)
        for name in motion.pictures:
            self.drawings.append(self._executor.submit(_draw, name, motion, self._folder))


def _draw(name: str, motion: Motion, folder: Path) -> list[Path]:
    # Only who draws loads matplotlib, which takes half a second.
    from simmpp.report.run_figures.drawing import draw_picture

    return draw_picture(name, motion, folder)


def _picture(point: Point) -> NDArray[np.uint8] | None:
    """What was rendered, if there is a scene and not only its rays."""
    source = point.config.ray_source
    return source.draw(point.config.picture, point.workload) if source.can_draw else None
