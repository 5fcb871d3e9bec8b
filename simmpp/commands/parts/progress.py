"""How a sweep gets on: a bar on a terminal, a line now and then in a pipe."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

from simmpp.commands.parts.terminal import errors, notice
from simmpp.common.units import counted
from simmpp.sweeps.journal import FILE as JOURNAL
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.plan import Plan
from simmpp.sweeps.profits import best_policy
from simmpp.sweeps.sweep import Watcher

LINES = 10
"""Lines that a pipe gets in all, if all simulations are known from the start."""
BEST_S = 2
"""Seconds between two looks for the best policy."""


class CountingWatcher(Watcher):
    """Counts the simulations of a sweep."""

    total = done = failed = 0

    def planned(self, plan: Plan, finished: Mapping[str, Outcome]) -> None:
        """Begin to count; ``finished`` grows while the sweep runs."""
        self._plan, self._finished = plan, finished
        keys = {task.key for task in plan.tasks}
        self.total = len(keys)
        self.before = sum(key in keys and not finished[key].error for key in finished)
        self.done, self.failed = self.before, 0
        if self.before:
            notice(f"{self.before} of {self.total} simulations are there from before")
        if others := len(finished.keys() - keys):
            notice(f"{counted(others, 'simulation')} of other points stay in {JOURNAL} for later")

    def asked(self, tasks: int) -> None:
        """Count what an adaptive sweep adds while it runs, too."""
        self.total += tasks

    def simulated(self, outcome: Outcome) -> None:
        """Count a simulation, and whether it failed."""
        self.done += 1
        self.failed += bool(outcome.error)

    def notice(self, text: str) -> None:
        """Show what the sweep has to say, such as a workload that was not in the cache."""
        notice(text)

    def interrupted(self, call: str) -> None:
        """Say how far the sweep is, and by which call it goes on."""
        failed = f", {self.failed} failed" if self.failed else ""
        on = f"; to go on: {call}" if call else ""
        if self.total:
            notice(f"{self.done} of {counted(self.total, 'simulation')} done{failed}{on}")

    def more(self) -> str:
        """What failed, and which policy is the fastest so far."""
        best = best_policy(self._plan.rows(self._finished), self._plan.further)
        fastest = f"best so far: {best[0]} (time profit {best[1]:.2f})" if best else ""
        failed = f"{self.failed} failed" if self.failed else ""
        return ", ".join(filter(None, (failed, fastest)))


class LineWatcher(CountingWatcher):
    """A line whenever another tenth of the simulations is done, for files and pipes."""

    def planned(self, plan: Plan, finished: Mapping[str, Outcome]) -> None:
        """Begin the clock that the time left is worked out by."""
        super().planned(plan, finished)
        self._began_s, self._last_line = time.monotonic(), self.before

    def simulated(self, outcome: Outcome) -> None:
        """A line if that makes another tenth."""
        super().simulated(outcome)
        if LINES * (self.done - self._last_line) < self.total and self.done < self.total:
            return
        self._last_line = self.done
        per_task_s = (time.monotonic() - self._began_s) / (self.done - self.before)
        left_s = per_task_s * (self.total - self.done)
        parts = (f"{self.done} of {self.total}", f"about {left_s:.0f} s left", self.more())
        notice(", ".join(filter(None, parts)))


class BarWatcher(CountingWatcher):
    """A bar for tracing and one for the simulations."""

    def __init__(self, bars: Progress) -> None:
        self._bars = bars
        self._tracing: dict[str, TaskID] = {}
        self._drawing: TaskID | None = None

    def planned(self, plan: Plan, finished: Mapping[str, Outcome]) -> None:
        """Draw the bar."""
        super().planned(plan, finished)
        self._more, self._looked_s = "", -math.inf
        self._points = self._bars.add_task(
            "simulating", total=self.total, completed=self.done, more=""
        )

    def tracing(self, scene: str, done: int, total: int) -> None:
        """Draw the bar of a scene."""
        if scene not in self._tracing:
            self._tracing[scene] = self._bars.add_task(f"tracing {scene}", more="rays")
        self._bars.update(self._tracing[scene], completed=done, total=total)

    def drawing(self, done: int, total: int) -> None:
        """Draw a bar for the figures."""
        if self._drawing is None:
            self._drawing = self._bars.add_task("drawing", more="figures")
        self._bars.update(self._drawing, completed=done, total=total)

    def simulated(self, outcome: Outcome) -> None:
        """Move the bar."""
        super().simulated(outcome)
        if time.monotonic() - self._looked_s > BEST_S or self.done == self.total:
            self._more, self._looked_s = self.more(), time.monotonic()
        self._bars.update(self._points, completed=self.done, total=self.total, more=self._more)


@contextmanager
def progress_of_sweep(call: str = "") -> Iterator[Watcher]:
    """Who tells the user how a sweep gets on, and if it is interrupted by which call it goes on."""
    try:
        with _shown() as watcher:
            yield watcher
    except KeyboardInterrupt:
        watcher.interrupted(call)
        raise


@contextmanager
def _shown() -> Iterator[CountingWatcher]:
    console = errors()
    if not console.is_terminal:
        yield LineWatcher()
        return
    bars = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.completed:.0f} of {task.total:.0f}"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[more]}", markup=False),
        console=console,
        transient=True,
    )
    with bars:
        yield BarWatcher(bars)
