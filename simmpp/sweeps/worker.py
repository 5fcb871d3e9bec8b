"""What a worker does: one task after the other, keeping what consecutive ones share."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from threading import Lock
from typing import Generic, TypeVar

from simmpp.engine.simulate import simulate
from simmpp.errors import SimmppError
from simmpp.policy.table import POLICIES
from simmpp.sweeps.outcome import Outcome
from simmpp.sweeps.point import Point, make_point
from simmpp.sweeps.provenance import difference, result_versions
from simmpp.sweeps.rows import integers
from simmpp.sweeps.task import Task
from simmpp.sweeps.warm import warm_up
from simmpp.sweeps.workloads import shared_workload
from simmpp.workload.workload import Workload

Made = TypeVar("Made")


class TimedOut(SimmppError):
    """A point took longer than it may."""


class Kept(Generic[Made]):
    """The last things made, by key; threads wait for one that is being made."""

    def __init__(self, most: int) -> None:
        self._most, self._made, self._lock = most, OrderedDict[str, Made](), Lock()

    def get(self, key: str, make: Callable[[], Made]) -> Made:
        """What ``make`` has made for the key, now or before."""
        with self._lock:
            made = self._made.pop(key) if key in self._made else make()
            self._made[key] = made
            if len(self._made) > self._most:
                self._made.popitem(last=False)
        return made


_workloads: Kept[Workload] = Kept(2)
_points: Kept[tuple[Point, float]] = Kept(4)


def keep_workload(workload: Workload) -> None:
    """Let tasks in this process use what it has just traced."""
    _workloads.get(workload.digest, lambda: workload)


def run_task(task: Task, timeout_s: float | None, versions: Mapping[str, str] | None) -> Outcome:
    """Simulate; whatever goes wrong becomes the outcome's error, so that the sweep goes on.

    ``versions`` are those of who asks, if they may differ: results must not be mixed then.
    """
    try:
        if versions is not None:
            _compare(versions)
        return _simulated(task, timeout_s)
    except SimmppError as error:
        problem = str(error)
    except MemoryError:
        problem = "out of memory"
    except Exception as error:
        problem = f"{type(error).__name__}: {error}"
    return Outcome(task.key, error=" ".join(problem.split()))


def _compare(versions: Mapping[str, str]) -> None:
    if problem := difference(versions, result_versions(), "for the sweep", "for the worker"):
        raise SimmppError(f"the worker has other versions: {problem}")


def _simulated(task: Task, timeout_s: float | None) -> Outcome:
    settings = task.config.settings
    warm_up(settings.engine)
    workload = _workloads.get(task.digest, lambda: shared_workload(task.config, task.digest))
    point, placing_s = _points.get(task.placement_key, lambda: _placed(task, workload))
    began_s = time.perf_counter()

    def stop_in_time(rays_left: int) -> None:
        if timeout_s is not None and placing_s + time.perf_counter() - began_s > timeout_s:
            raise TimedOut(f"timeout: not finished after {timeout_s:g} s")

    stop_in_time(workload.n_rays)
    result = simulate(
        workload,
        point.machine,
        point.placement,
        task.policy,
        engine=settings.engine,
        ready_order=settings.ready_order,
        progress=stop_in_time,
    )
    everywhere = POLICIES[task.policy.name].all_resident
    return Outcome(
        task.key,
        integers(result),
        1.0 if everywhere else point.placement.effective_fraction,
        placing_s + time.perf_counter() - began_s,
    )


def _placed(task: Task, workload: Workload) -> tuple[Point, float]:
    """The point and the seconds that drawing its placement took."""
    began_s = time.perf_counter()
    point = make_point(task.config, workload, task.seed)
    return point, time.perf_counter() - began_s
