"""Writes the timelines of several policies into one file while they are simulated."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Protocol

from simmpp.common.files import naming, replaced
from simmpp.engine.record.log import Sink
from simmpp.machine.machine import NIC, THREAD, Machine
from simmpp.policy.parameters import PolicyParameters
from simmpp.report.timeline.slices import Timeline, TimelinePart, Window
from simmpp.run.point import PolicyRun

_SERVERS = {THREAD: "thread", NIC: "network card"}
SUFFIXES = (".json", ".json.gz", ".parquet")


class TimelineFile(Protocol):
    """A file that timelines go into, run after run, part after part."""

    def begin(self, title: str, processors: int, server: str = "") -> None:
        """What is written from now on is the run of this policy."""

    def add(self, part: TimelinePart) -> None:
        """Write a part of the timeline."""

    def close(self) -> None:
        """End the file; what was written can be read."""


class TimelineRecorder:
    """One file; its format follows from its name, one of SUFFIXES."""

    needs_counters = False

    def __init__(self, path: Path, machine: Machine, window: Window | None = None) -> None:
        self._path = path
        self._problem: OSError | None = None
        with ExitStack() as stack:
            self._file = _file(path.name.lower(), stack.enter_context(replaced(path)))
            self._closing = stack.pop_all()
        self._machine = machine
        self._window = window or Window()
        self._timeline: Timeline | None = None

    def begin(self, policy: PolicyParameters) -> Sink:
        """What gets the event log of a policy's run."""
        nb, service = self._machine.processors, self._machine.service
        self._file.begin(policy.title, nb, _SERVERS.get(service, ""))
        timeline = Timeline(nb, self._machine.probe_ps, self._window, service)
        self._timeline = timeline
        return lambda rows: self._add(timeline.add(rows))

    def end(self, run: PolicyRun) -> None:
        """The run that was begun last is over."""
        if self._timeline is not None:
            self._add(self._timeline.end(run.result.makespan_ps))

    def _add(self, part: TimelinePart) -> None:
        try:
            with naming(self._path):
                self._file.add(part)
        except OSError as error:
            self._problem = error
            raise

    def close(self) -> None:
        """End the file; what was simulated until now can be read, unless the disk was full."""
        with self._closing:
            if self._problem is not None:
                raise self._problem
            self._file.close()


def _file(name: str, path: Path) -> TimelineFile:
    """What writes to ``path`` in the format of ``name``."""
    if name.endswith(".parquet"):
        from simmpp.report.timeline.table import TimelineTable

        return TimelineTable(path)
    from simmpp.report.timeline.trace_events import TraceEvents

    return TraceEvents(path, is_zipped=name.endswith(".gz"))
