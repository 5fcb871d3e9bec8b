"""Simulating for an advice: on the pools of sweeps, each task once, until the time is over."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Iterator, Sequence

from simmpp.common.errors import ConfigError
from simmpp.sweeps.executors import Pool, pool_for
from simmpp.sweeps.scheduler import outcomes
from simmpp.sweeps.task import Task
from simmpp.sweeps.worker import run_task

LEAST_PS = 1
"""A makespan of nothing would have no ratio to others."""


class OutOfTime(Exception):
    """The seconds that were given are over."""


class Watcher:
    """Is told how an advice gets on; this one says nothing."""

    def tracing(self, done: int, total: int) -> None:
        """Rays done and rays known of the workload."""

    def simulated(self, runs: int) -> None:
        """So many simulations are done."""

    def notice(self, text: str) -> None:
        """Something that the user should know."""


class Run:
    """Simulates tasks on a pool, each once, and counts them."""

    def __init__(self, pool: Pool, deadline_s: float = math.inf, watcher: Watcher | None = None):
        self._pool, self._deadline_s, self._watcher = pool, deadline_s, watcher or Watcher()
        self._makespans: dict[str, float] = {}
        self._exceeds: dict[str, int] = {}

    @classmethod
    def never(cls) -> Run:
        """One that is asked nothing."""
        return cls(pool_for(1, None, run_task))

    @property
    def count(self) -> int:
        """Simulations so far."""
        return len(self._makespans)

    def __call__(self, tasks: Sequence[Task]) -> list[float]:
        """The makespan of each.

        Raises OutOfTime when the time is over, ConfigError for a simulation that failed.
        """
        found = {task.key: makespan for task, makespan in self.one_by_one(tasks)}
        return [found[task.key] for task in tasks]

    def exceeds_bytes(self, task: Task) -> int:
        """By how much more than its capacity a node holds, where nothing keeps it within."""
        self([task])
        return self._exceeds[task.key]

    def one_by_one(self, tasks: Sequence[Task]) -> Iterator[tuple[Task, float]]:
        """Each task with its makespan as soon as it is known; raises the same."""
        by_key = {task.key: task for task in tasks}
        known = {key: self._makespans[key] for key in by_key if key in self._makespans}
        yield from ((by_key[key], makespan) for key, makespan in known.items())
        new = {key: task for key, task in by_key.items() if key not in known}
        for outcome in outcomes(deque(new.values()), self._pool):
            if outcome.error:
                raise ConfigError(f"a simulation failed: {outcome.error}")
            found = outcome.numbers.get("makespan_ps")
            makespan = math.inf if found is None else float(max(LEAST_PS, found))
            self._makespans[outcome.key] = makespan
            self._exceeds[outcome.key] = outcome.numbers.get("exceeds_bytes", 0)
            yield by_key[outcome.key], makespan
            self._watcher.simulated(self.count)
            if time.monotonic() > self._deadline_s:
                raise OutOfTime
