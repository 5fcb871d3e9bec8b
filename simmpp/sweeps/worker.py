"""What a worker does: one task after the other, keeping what consecutive ones share.

``run_task`` is called in whatever process or thread does the work. Workloads and placements are
kept from one call to the next. The seconds of an outcome are those that its task would have taken
alone, so those of a placement that several tasks share count for each of them.
"""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from threading import Lock
from typing import Generic, TypeVar

from simmpp.common.code.kept import compiled_by_one
from simmpp.common.errors import SimmppError
from simmpp.common.modules import ENGINE
from simmpp.engine.filling import effective_fraction
from simmpp.engine.simulate import simulate
from simmpp.machine.presets import machine
from simmpp.methods.case import Case
from simmpp.methods.table import METHODS, Method
from simmpp.model.synthetic import synthetic
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.run.inputs import shared_workload
from simmpp.run.provenance import difference, result_versions
from simmpp.sweeps.deadline import ended_after
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.task import Task
from simmpp.workload.workload import Workload

Kind = TypeVar("Kind")


def run_task(
    task: Task, timeout_s: float | None = None, versions: Mapping[str, str] | None = None
) -> Outcome:
    """Simulate; whatever goes wrong becomes the outcome's error, so that the sweep goes on.

    ``versions`` are those of who asks, if they may differ: results must not be mixed then.
    """
    try:
        if versions is not None:
            _refuse_other(versions)
        return _outcome(task, timeout_s)
    except SimmppError as error:
        problem = str(error)
    except MemoryError:
        problem = "out of memory"
    except Exception as error:
        problem = f"{type(error).__name__}: {error}"
    return Outcome(task.key, error=" ".join(problem.split()))


def keep_workload(workload: Workload) -> None:
    """Let tasks in this process use what it has just traced."""
    _workloads.get(workload.digest, lambda: workload)


def _refuse_other(versions: Mapping[str, str]) -> None:
    if problem := difference(versions, result_versions(), "for the sweep", "for the worker"):
        raise SimmppError(f"the worker has other versions: {problem}")


def _outcome(task: Task, timeout_s: float | None) -> Outcome:
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
        config.memory.share,
        settings.engine,
        settings.ready_order,
        task.seed,
        place=lambda: watch.count(_placements.get(task.placement_key, lambda: _drawn(task, case))),
        tick=watch.look,
    )
    with ended_after(timeout_s):
        numbers = dict(method.numbers(case))
    spent = watch.seconds
    return Outcome(task.key, numbers, _effective_fraction(case, method), spent.wall, spent.cpu)


def _drawn(task: Task, case: Case) -> tuple[Placement, Seconds]:
    """The placement and the seconds that drawing it took."""
    began, config = now(), task.config
    placement = place(
        case.workload, case.machine.processors, config.memory, config.settings.placement, task.seed
    )
    return placement, now() - began


def _effective_fraction(case: Case, method: Method) -> float:
    """The share of the objects that is really resident; the model's own where nothing is placed."""
    if method.is_placed:
        return effective_fraction(case.workload, case.machine, case.place(), case.policy)
    if case.policy.rules.all_resident:
        return 1.0
    return max(float(case.fraction), 1 / case.machine.processors)


class TimedOut(SimmppError):
    """A point took longer than it may."""


@dataclass(frozen=True)
class Seconds:
    """A span of time."""

    wall: float
    cpu: float
    """Of this thread."""

    def __add__(self, other: Seconds) -> Seconds:
        return Seconds(self.wall + other.wall, self.cpu + other.cpu)

    def __sub__(self, other: Seconds) -> Seconds:
        return Seconds(self.wall - other.wall, self.cpu - other.cpu)


def now() -> Seconds:
    """Since some moment that is always the same."""
    return Seconds(time.perf_counter(), time.thread_time())


class Stopwatch:
    """Times one task; what it shares with others counts whoever made it."""

    def __init__(self, timeout_s: float | None) -> None:
        self._timeout_s, self._began, self._shared = timeout_s, now(), Seconds(0.0, 0.0)

    def count(self, shared: tuple[Kind, Seconds]) -> Kind:
        """Take something with the seconds that it took: the rest begins here."""
        thing, self._shared = shared
        self._began = now()
        return thing

    @property
    def seconds(self) -> Seconds:
        """What was shared and the rest."""
        return self._shared + (now() - self._began)

    def look(self, rays_left: int) -> None:
        """Raise TimedOut if it is time."""
        if self._timeout_s is not None and self.seconds.wall > self._timeout_s:
            raise TimedOut(f"timeout: not finished after {self._timeout_s:g} s")


class Kept(Generic[Kind]):
    """The last few things of a kind, by key; threads wait for one that is being made."""

    def __init__(self, most: int) -> None:
        self._most, self._things, self._lock = most, OrderedDict[str, Kind](), Lock()

    def get(self, key: str, make: Callable[[], Kind]) -> Kind:
        """What ``make`` has made for the key, now or before."""
        with self._lock:  # while it is made, too: another thread would make the same
            thing = self._things.pop(key) if key in self._things else make()
            self._things[key] = thing
            if len(self._things) > self._most:
                self._things.popitem(last=False)
        return thing


_workloads: Kept[Workload] = Kept(2)
_placements: Kept[tuple[Placement, Seconds]] = Kept(4)


@cache
def warm_up(engine: str) -> None:
    """Simulate the smallest machine that sends messages, once per process.

    It is only there to have compiled code loaded, or made, before any task is timed.
    """
    # with this seed each ray starts at one PE and needs the object of the other
    workload, processors = synthetic(rays=2, steps=1, objects=2, seed=2), 2
    placement = place(workload, processors, Memory(), PlacementRules(), seed=0)
    policy = PolicyParameters("concurrent")
    with compiled_by_one(ENGINE):
        simulate(workload, machine(processors=processors), placement, policy, engine=engine)
