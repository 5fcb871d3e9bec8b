"""One point: the policies of a configuration on one workload, one machine and one placement."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

from simmpp.common.places import misplaced
from simmpp.common.units import shown, write_bytes
from simmpp.config.config import Config
from simmpp.engine.capacity import clash, fits, needs_of
from simmpp.engine.record.log import Sink
from simmpp.engine.record.recording import NOTHING, Recording
from simmpp.engine.result import Result
from simmpp.engine.simulate import simulate
from simmpp.machine.limits import bound_ps
from simmpp.machine.machine import Machine
from simmpp.methods.table import SIMULATE
from simmpp.placement.place import place
from simmpp.placement.placement import Placement
from simmpp.placement.rooms import TO_FILL
from simmpp.policy.parameters import CEILING, REFERENCE, PolicyParameters
from simmpp.workload.workload import Workload


@dataclass(frozen=True, eq=False)
class Point:
    """What all policies of a point share: the machine, and the placement drawn once."""

    config: Config
    workload: Workload
    machine: Machine
    placement: Placement
    seed: int

    @property
    def bound_ps(self) -> int:
        """Total compute / the sum of speeds, nb if they are 1, rounded up: none can be faster."""
        return bound_ps(self.workload, self.machine)


@dataclass(frozen=True, eq=False)
class PolicyRun:
    """One policy at one point."""

    parameters: PolicyParameters
    result: Result
    named: bool
    """The configuration names it; otherwise it is there to be compared with."""
    wall_s: float
    """Time that the event loop took here."""

    @property
    def all_resident(self) -> bool:
        """Every object is in every memory, whatever the fraction."""
        return self.parameters.rules.all_resident


def make_point(config: Config, workload: Workload, seed: int | None = None) -> Point:
    """Draw the placement; ``seed`` is the first of the configuration's by default.

    Raises ConfigError if the memory or the machine's shape does not fit.
    """
    refuse_models(config)
    seed = config.settings.seeds[0] if seed is None else seed
    machine = config.machine_for(config.processors)
    for parameters, _ in policies_of(config):
        refuse_clash(config, parameters)
    placement = place(workload, config.processors, config.memory, config.settings.placement, seed)
    return Point(config, workload, machine, placement, seed)


def refuse_models(config: Config) -> None:
    """Raise ConfigError for a method that simulates nothing."""
    method = config.settings.method
    if method != SIMULATE:
        problem = f"value {method!r}: expected {SIMULATE} here"
        raise misplaced(("method",), problem, config.places)


def refuse_clash(config: Config, policy: PolicyParameters) -> None:
    """Raise ConfigError for what can't be combined with a capacity, or not without one."""
    capacity = config.memory.capacity
    if capacity is None and config.memory.fills:
        raise misplaced(("memory", "fraction"), TO_FILL, config.places)
    if capacity is None:
        return
    if problem := clash(config.machine_for(config.processors), policy):
        value = shown(write_bytes(capacity) if isinstance(capacity, int) else capacity)
        raise misplaced(("memory", "capacity"), f"value {value}: {problem}", config.places)


def policies_of(config: Config) -> list[tuple[PolicyParameters, bool]]:
    """The policies to run, and whether the configuration names them; the reference comes first."""
    named = config.settings.policy
    names = [parameters.name for parameters in named]
    chosen = [(parameters, True) for parameters in named]
    others = [name for name in (REFERENCE, CEILING) if name not in names]
    chosen += [(config.reading.policy(name), False) for name in others]
    return sorted(chosen, key=lambda pair: pair[0].name != REFERENCE)


def run_point(
    point: Point,
    *,
    record: Recording = NOTHING,
    log_of: Callable[[PolicyParameters], Sink | None] = lambda _: None,
    progress: Callable[[str, int], None] | None = None,
) -> Iterator[PolicyRun]:
    """Simulate the policies that fit one after the other, yielding each as it is finished.

    ``log_of`` gives what gets the event log of a policy's run, if anything. ``progress(title, rays
    left)`` is called now and then.
    """
    settings = point.config.settings
    scene_bytes = int(point.workload.object_bytes.sum())
    for parameters, named in policies_of(point.config):
        if point.placement.capacity is not None:
            needs = needs_of(point.workload, point.machine, point.placement, parameters)
            if not fits(needs, point.placement, scene_bytes):
                continue
        began_s = time.perf_counter()
        result = simulate(
            point.workload,
            point.machine,
            point.placement,
            parameters,
            engine=settings.engine,
            ready_order=settings.ready_order,
            seed=point.seed,
            record=replace(record, log=log_of(parameters) or False),
            progress=progress and partial(progress, parameters.title),
        )
        yield PolicyRun(parameters, result, named, time.perf_counter() - began_s)


def reference_of(runs: Sequence[PolicyRun]) -> PolicyRun:
    """The run that profits are measured against."""
    return next(run for run in runs if run.parameters.name == REFERENCE)


def ceiling_of(runs: Sequence[PolicyRun]) -> PolicyRun | None:
    """The run with the whole scene in every memory, if it is finished."""
    return next((run for run in runs if run.all_resident), None)
