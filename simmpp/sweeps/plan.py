"""A sweep before it runs: its points, what has to be simulated for them, and what that is of.

What does not go together is refused here, before anything runs: two points of one name, a policy
that a method does not know, a key that someone set and that the sweep sets otherwise at each point.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.common.places import misplaced
from simmpp.config.axes import POINTS, SAME, keys_of
from simmpp.config.config import Config, Source
from simmpp.config.defaults import READING
from simmpp.methods.columns import BOUNDED, KEYS, METHOD, result_columns, told_by
from simmpp.methods.table import METHODS
from simmpp.run.point import refuse_clash
from simmpp.run.provenance import result_versions
from simmpp.run.record import FAILED, FINISHED, SIMULATIONS, record, recorded
from simmpp.run.rows import in_order, point_row
from simmpp.sweeps.grid import GridPoint, further_columns, grid
from simmpp.sweeps.growth import GROWS, NAMES, SWEPT, Identity, meanings
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.profits import NOISY, SIMULATION
from simmpp.sweeps.task import Task, task_of

SET = "--set "
"""What the places of keys begin with that were set on the command line."""
TELLING = ("policy.", "scene.", "reading", "point")
"""Columns of swept keys with which a policy, a scene or a machine of one name is another one."""


@dataclass(frozen=True, eq=False)
class PlannedPoint:
    """A point, the simulation that it needs, and the name of its scene."""

    point: GridPoint
    task: Task
    scene: str


@dataclass(frozen=True, eq=False)
class Plan:
    """All points of a sweep."""

    config: Config
    points: tuple[PlannedPoint, ...]
    further: tuple[str, ...]
    """Columns beyond those that all rows have."""

    @property
    def profit_keys(self) -> tuple[str, ...]:
        """Columns of ``profits.csv`` beyond those that all have."""
        swept = {key for axis in self.config.axes.values() for key in keys_of(axis)}
        return (*self.further, METHOD) if METHOD in swept else self.further

    def result_columns(self, rows: Sequence[Row]) -> tuple[str, ...]:
        """Columns of ``results.csv`` with these rows."""
        uses = {use for planned in self.points for use in planned.point.policy.uses}
        if any(planned.point.config.memory.capacity is not None for planned in self.points):
            uses.add(BOUNDED)
        configs = (planned.point.config for planned in self.points)
        uses |= {use for c in configs for use in c.machine_for(c.processors).uses}
        return result_columns(self.further, uses | told_by(rows))

    @property
    def tasks(self) -> list[Task]:
        """What is to be simulated, once each; neighbours share a workload and a placement."""
        tasks = {planned.task.key: planned.task for planned in self.points}
        first: dict[str, int] = {}
        for n, task in enumerate(tasks.values()):
            first.setdefault(task.digest, n)
            first.setdefault(task.placement_key, n)
        return sorted(tasks.values(), key=lambda t: (first[t.digest], first[t.placement_key]))

    @property
    def identity(self) -> Identity:
        """What its results are of; a reading counts by what it gives."""
        config = recorded(self.config).items()
        policies = dict.fromkeys((p.point.policy, _told(p.point)) for p in self.points)
        rays = dict.fromkeys(
            (p.scene + _told(p.point), p.point.config.asked, p.task.digest) for p in self.points
        )
        configs = {
            id(p.point.comparison): (p.point.config, _told(p.point)) for p in self.points
        }.values()
        return {
            "versions": result_versions(),
            "config": {key: said for key, said in config if key not in (*GROWS, READING)},
            SWEPT: sorted(_swept_everywhere(self.config)),
            NAMES: meanings(policies, rays, configs, self.config.axes.get(POINTS, ())),
        }

    @property
    def workloads(self) -> dict[str, list[str]]:
        """Digests of the workloads of each scene, by its name."""
        names = dict.fromkeys(planned.scene for planned in self.points)
        pairs = {(planned.scene, planned.task.digest) for planned in self.points}
        return {name: sorted(digest for scene, digest in pairs if scene == name) for name in names}

    def record(self, outcomes: Mapping[str, Outcome]) -> dict[str, Any]:
        """The content of ``run.json``: what it is of, and how far it is."""
        configs = {id(p.point.comparison): p.point.comparison for p in self.points}.values()
        machines = [of.config.machine_for(of.config.processors) for of in configs]
        cells = [{"processors": of.config.processors, **of.swept} for of in configs]
        keys = {planned.task.key for planned in self.points}
        failures = [bool(outcomes[key].error) for key in keys if key in outcomes]
        further = {
            SIMULATIONS: len(keys),
            FINISHED: failures.count(False),
            FAILED: failures.count(True),
            "further_columns": list(self.further),
        }
        return record(self.config, self.workloads, machines, len(self.points), further, cells)

    def rows(self, outcomes: Mapping[str, Outcome]) -> list[Row]:
        """Rows of the points that are finished, sorted by their keys."""
        return in_order((_row(*finished) for finished in self._finished(outcomes)), self.further)

    def timings(self, outcomes: Mapping[str, Outcome], trace_s: Mapping[str, float]) -> list[Row]:
        """Seconds that each of these rows took; tracing is empty where the rays were cached."""
        times = (
            _row(planned, outcome)
            | {"trace_s": trace_s.get(planned.task.digest, ""), "wall_s": outcome.wall_s}
            for planned, outcome in self._finished(outcomes)
        )
        return in_order(times, self.further)

    def _finished(self, outcomes: Mapping[str, Outcome]) -> Iterator[tuple[PlannedPoint, Outcome]]:
        for planned in self.points:
            if planned.task.key in outcomes:
                yield planned, outcomes[planned.task.key]

    @property
    def timing_columns(self) -> tuple[str, ...]:
        """Columns of ``timings.csv``."""
        return (*KEYS, *self.further, "trace_s", "wall_s")


def plan_of(config: Config) -> Plan:
    """Work out what a sweep needs.

    Raises InputError for values that do not go together, and for scenes that can't be read.
    """
    refuse_overruled(config)
    workloads: dict[str, tuple[str, str]] = {}
    points: list[PlannedPoint] = []
    for point in grid(config):
        _refuse_unknown(point)
        refuse_clash(point.config, point.policy)
        inputs = repr((point.config.scene_spec, point.config.asked))
        if inputs not in workloads:
            workloads[inputs] = point.config.ray_source.name_and_digest(point.config.picture)
        name, digest = workloads[inputs]
        points.append(PlannedPoint(point, task_of(point, digest), name))
    further = further_columns(config)
    _check_names(points, further)
    return Plan(config, tuple(points), further)


def _refuse_unknown(point: GridPoint) -> None:
    """Raise ConfigError for what the method of a point has no notion of."""
    config = point.config
    method = config.settings.method
    known = METHODS[method].policies
    if known is None:
        return
    if point.policy.name not in known:
        problem = f"value {point.policy.name!r}: method {method} knows {' and '.join(known)} only"
        raise misplaced(("policy",), problem, config.places)
    if config.memory.bytes is not None or config.memory.fills:
        problem = f"method {method} knows shares: expected memory.fraction, a share"
        key = "fraction" if config.memory.fills else "bytes"
        raise misplaced(("memory", key), problem, config.places)


def _check_names(points: list[PlannedPoint], further: tuple[str, ...]) -> None:
    """Raise ConfigError if points that differ would have one name, as two files of one name do."""
    names = [name for name in (*KEYS, *further, METHOD) if name != "effective_fraction"]
    tasks: dict[tuple[object, ...], str] = {}
    for planned in points:
        row = _row(planned, Outcome(planned.task.key))
        key = tuple(row[name] for name in names)
        if tasks.setdefault(key, planned.task.key) != planned.task.key:
            text = ", ".join(f"{name} {row[name]}" for name in names)
            raise ConfigError(f"sweep: two different points are both called {text}; name them")


def _told(point: GridPoint) -> str:
    """The swept keys that tell apart what names alone do not: parts of policies and scenes."""
    swept = {key: value for key, value in point.swept.items() if key.startswith(TELLING)}
    return f" at {swept}" if swept else ""


def _row(planned: PlannedPoint, outcome: Outcome) -> Row:
    """The row of a point, and which simulation it is of."""
    point = planned.point
    row = point_row(
        point.config,
        planned.scene,
        point.policy.title,
        point.seed,
        outcome.numbers,
        outcome.effective_fraction,
        outcome.error,
    )
    noisy = {NOISY: True} if planned.task.is_noisy else {}
    return {**row, **point.swept, SIMULATION: planned.task.key, **noisy}


def refuse_overruled(config: Config) -> None:
    """Raise ConfigError for a ``--set`` without effect, and for a size of memory given two ways.

    A key of the file that is swept as well is what other commands take, and no mistake.
    """
    if config.source is None:
        return
    swept = _swept_everywhere(config)
    _refuse_set(config.source, swept)
    for key, other in SAME.items():
        path = tuple(key.split("."))
        if other in swept and _given(config.source.data, path):
            problem = f"expected none: {other} is swept, and says the same in another way"
            raise misplaced(path, problem, config.places)


def _swept_everywhere(config: Config) -> list[str]:
    """The keys that each point of the sweep sets; one of named points may be set in some only."""
    return [
        key
        for axis in config.axes.values()
        for key in axis[0].assignments
        if all(key in choice.assignments for choice in axis)
    ]


def _refuse_set(source: Source, swept: list[str]) -> None:
    given = {}
    for path, (where, _) in source.places.items():
        if where.startswith("--"):  # a short cut has no key in its name
            given[where] = where.removeprefix(SET) if where.startswith(SET) else str(path[0])
    for where, key in given.items():
        for name in swept:
            if key == name or key.startswith(f"{name}."):
                raise ConfigError(f"{name!r} is swept; set sweep.{name}", where=where)


def _given(data: object, path: tuple[str, ...]) -> bool:
    for part in path:
        data = data.get(part) if isinstance(data, dict) else None
    return data is not None
