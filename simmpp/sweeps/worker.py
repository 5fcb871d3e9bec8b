"""What a worker does: one task after the other, keeping what consecutive ones share."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from threading import Lock
from typing import Generic, TypeVar

from simmpp.errors import SimmppError
from simmpp.placement.place import place
from simmpp.placement.placement import Placement
from simmpp.policy.table import POLICIES
from simmpp.sweeps.case import Case
from simmpp.sweeps.methods import METHODS, Method
from simmpp.sweeps.outcome import Outcome
from simmpp.sweeps.provenance import difference, result_versions
from simmpp.sweeps.stopwatch import Seconds, Stopwatch, now
from simmpp.sweeps.task import Task
from simmpp.sweeps.warm import warm_up
from simmpp.sweeps.workloads import shared_workload
from simmpp.workload.workload import Workload

Made = TypeVar("Made")


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
_placements: Kept[tuple[Placement, Seconds]] = Kept(4)


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
    config, settings = task.config, task.config.settings
    method = METHODS[settings.method]
    if method.is_placed:
        warm_up(settings.engine)
    workload = _workloads.get(task.digest, lambda: shared_workload(config, task.digest))
    machine, watch = config.machine_for(config.processors), Stopwatch(timeout_s)
    watch.look(workload.n_rays)
    case = Case(
        workload,
        machine,
        task.policy,
        config.memory.fraction,
        settings.engine,
        settings.ready_order,
        place=lambda: watch.count(_placements.get(task.placement_key, lambda: _drawn(task, case))),
        tick=watch.look,
    )
    numbers = method.numbers(case)
    took = watch.seconds
    return Outcome(task.key, numbers, _effective_fraction(case, method), took.wall, took.cpu)


def _drawn(task: Task, case: Case) -> tuple[Placement, Seconds]:
    """The placement and the seconds that drawing it took."""
    began, config = now(), task.config
    placement = place(
        case.workload, case.machine.processors, config.memory, config.placement_rules, task.seed
    )
    return placement, now() - began


def _effective_fraction(case: Case, method: Method) -> float:
    """The share of the objects that is really resident; the model's own where nothing is placed."""
    if POLICIES[case.policy.name].all_resident:
        return 1.0
    if method.is_placed:
        return case.place().effective_fraction
    return max(float(case.fraction), 1 / case.machine.processors)
