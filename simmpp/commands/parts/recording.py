"""What watches a run for ``simmpp run``: the timeline and the pictures that were asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Future, as_completed
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from simmpp.commands.parts import options
from simmpp.commands.parts.terminal import notice, progress_bars
from simmpp.common.errors import ConfigError
from simmpp.common.modules import PICTURES
from simmpp.common.units import format_ps
from simmpp.engine.record.log import Sink
from simmpp.policy.parameters import PolicyParameters
from simmpp.report.run_figures.recorder import FiguresRecorder
from simmpp.report.timeline.recorder import SUFFIXES, TimelineRecorder
from simmpp.report.timeline.slices import Window
from simmpp.run.point import Point, PolicyRun
from simmpp.sweeps.executors import processes


class Looks(NamedTuple):
    """What is to be written for people to look at."""

    picture: Path | None
    until_ps: int | None
    results: Path | None
    timeline: Path | None
    window_ps: tuple[int, int] | None
    figures: Path | None


def check_timeline(path: Path | None, window: tuple[int, int] | None) -> None:
    """Raise ConfigError unless a timeline can be written there."""
    if path is None and window is not None:
        raise ConfigError("--timeline-window: expected --timeline FILE beside it")
    if path is not None and not path.name.lower().endswith(SUFFIXES):
        expected = f"expected a file {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}"
        raise ConfigError(f"--timeline: value {str(path)!r}: {expected}")
    options.writable(path, "--timeline")


def warn_of_window(runs: Sequence[PolicyRun], looks: Looks) -> None:
    """Say for which runs a timeline has nothing, as they are over before its window begins."""
    start_ps = looks.window_ps[0] if looks.window_ps else 0
    over = [
        f"{run.parameters.title} at {format_ps(run.result.makespan_ps)}"
        for run in runs
        if run.result.makespan_ps <= start_ps
    ]
    if over and looks.timeline:
        told = f"nothing happens from {format_ps(start_ps)} on: {', '.join(over)} ended"
        notice(f"warning: --timeline-window: {told}")


class Recorder(Protocol):
    """Watches the runs of a point, one after the other."""

    needs_counters: bool
    """Whether the run is to record its counters, and the links crossed for each ray."""

    def begin(self, policy: PolicyParameters) -> Sink | None:
        """What gets the event log of a policy's run, if anything."""

    def end(self, run: PolicyRun) -> None:
        """The run that was begun last is over."""


@contextmanager
def recorders_of(point: Point, looks: Looks) -> Iterator[list[Recorder]]:
    """What writes the timeline and the pictures; the timeline is ended whatever happens."""
    with ExitStack() as stack:
        recorders: list[Recorder] = []
        if looks.timeline is not None:
            window = Window(*looks.window_ps) if looks.window_ps else None
            timeline = TimelineRecorder(looks.timeline, point.machine, window)
            stack.callback(timeline.close)
            recorders.append(timeline)
        figures: FiguresRecorder | None = None
        if looks.figures is not None:
            executor = stack.enter_context(processes(options.available_cores(), PICTURES))
            figures = FiguresRecorder(looks.figures, point, executor)
            recorders.append(figures)
        yield recorders
        if figures is not None:
            _wait_for(figures.drawings)


def _wait_for(drawings: Sequence[Future[list[Path]]]) -> None:
    """Until all pictures are drawn, with a bar."""
    with progress_bars() as bars:
        task = bars.add_task("drawing", total=len(drawings))
        for drawing in as_completed(drawings):
            drawing.result()
            bars.advance(task)


def sink_of(recorders: Sequence[Recorder], policy: PolicyParameters) -> Sink | None:
    """What hands the event log of a policy's run to all who want it."""
    sinks = [sink for recorder in recorders if (sink := recorder.begin(policy)) is not None]

    def hand_on(rows: NDArray[np.void]) -> None:
        for sink in sinks:
            sink(rows)

    return hand_on if sinks else None
