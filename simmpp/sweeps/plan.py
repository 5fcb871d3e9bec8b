"""A sweep before it runs: its points, what has to be simulated for them, and what that is of."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.common.places import misplaced
from simmpp.config.axes import SAME, keys_of
from simmpp.config.config import Config, Source, described
from simmpp.methods.columns import KEYS, METHOD, NUMBERS
from simmpp.methods.table import METHODS
from simmpp.run.inputs import name_and_digest
from simmpp.run.provenance import result_versions
from simmpp.run.rows import in_order
from simmpp.sweeps.grid import GridPoint, further_columns, grid
from simmpp.sweeps.journal import Outcome
from simmpp.sweeps.profits import SIMULATION
from simmpp.sweeps.task import Task, task_of

IRRELEVANT = ("check",)
"""Keys that decide no row."""


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

    @property
    def tasks(self) -> list[Task]:
        """What is to be simulated, once each; neighbours share a workload and a placement."""
        tasks = {each.task.key: each.task for each in self.points}
        places: dict[str, dict[str, list[Task]]] = {}
        for task in tasks.values():
            of_workload = places.setdefault(task.digest, {})
            of_workload.setdefault(task.placement_key, []).append(task)
        return [task for groups in places.values() for group in groups.values() for task in group]

    @property
    def identity(self) -> dict[str, Any]:
        """What must be equal for results to be continued."""
        config = {k: v for k, v in described(self.config).items() if k not in IRRELEVANT}
        keys = "".join(sorted({each.task.key for each in self.points}))
        return {
            "versions": result_versions(),
            "config": config,
            "workloads": self.workloads,
            "points": hashlib.sha256(keys.encode()).hexdigest(),
        }

    @property
    def workloads(self) -> dict[str, list[str]]:
        """Digests of the workloads of each scene, by its name."""
        names = dict.fromkeys(each.scene for each in self.points)
        pairs = {(each.scene, each.task.digest) for each in self.points}
        return {name: sorted(digest for scene, digest in pairs if scene == name) for name in names}

    def rows(self, outcomes: Mapping[str, Outcome]) -> list[Row]:
        """Rows of the points that are finished, sorted by their keys."""
        done = (each for each in self.points if each.task.key in outcomes)
        return in_order((_row(each, outcomes[each.task.key]) for each in done), self.further)

    def timings(self, outcomes: Mapping[str, Outcome], trace_s: Mapping[str, float]) -> list[Row]:
        """Seconds that each of these rows took; tracing is empty where the rays were cached."""
        times: list[Row] = []
        for each in self.points:
            if (outcome := outcomes.get(each.task.key)) is not None:
                row = _row(each, outcome)
                row |= {"trace_s": trace_s.get(each.task.digest, ""), "wall_s": outcome.wall_s}
                times.append(row)
        return in_order(times, self.further)

    @property
    def timing_columns(self) -> tuple[str, ...]:
        """Columns of ``timings.csv``."""
        return (*KEYS, *self.further, "trace_s", "wall_s")


def plan(config: Config) -> Plan:
    """Work out what a sweep needs.

    Raises InputError for values that do not go together, and for scenes that can't be read.
    """
    refuse_overruled(config)
    workloads: dict[str, tuple[str, str]] = {}
    points: list[PlannedPoint] = []
    for point in grid(config):
        _refuse_unknown(point)
        made_of = repr((point.config.scene_spec, point.config.picture))
        if made_of not in workloads:
            workloads[made_of] = name_and_digest(point.config)
        name, digest = workloads[made_of]
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
    if config.memory.bytes is not None:
        problem = f"method {method} knows shares: expected memory.fraction"
        raise misplaced(("memory", "bytes"), problem, config.places)


def _check_names(points: list[PlannedPoint], further: tuple[str, ...]) -> None:
    """Raise ConfigError if points that differ would have one name, as two files of one name do."""
    names = [name for name in (*KEYS, *further, METHOD) if name != "effective_fraction"]
    tasks: dict[tuple[object, ...], str] = {}
    for each in points:
        row = _row(each, Outcome(each.task.key))
        key = tuple(row[name] for name in names)
        if tasks.setdefault(key, each.task.key) != each.task.key:
            text = ", ".join(f"{name} {row[name]}" for name in names)
            raise ConfigError(f"sweep: two different points are both called {text}; name them")


def _row(planned: PlannedPoint, outcome: Outcome) -> Row:
    """The row of a point; that of a failed one has its error in place of numbers."""
    point = planned.point
    memory, settings = point.config.memory, point.config.settings
    return {
        "scene": planned.scene,
        "processors": point.config.processors,
        "fraction": "" if memory.bytes is not None else float(memory.fraction),
        "effective_fraction": "" if outcome.error else outcome.effective_fraction,
        "policy": point.policy.title,
        "seed": point.seed,
        **point.swept,
        "method": settings.method,
        "engine": settings.engine if METHODS[settings.method].uses_engine else "",
        **dict.fromkeys(NUMBERS, ""),
        **outcome.numbers,
        "error": outcome.error,
        SIMULATION: planned.task.key,
    }


# --- keys that someone set and that a sweep sets otherwise at every point: refused, not ignored ---


SET = "--set "


def refuse_overruled(config: Config) -> None:
    """Raise ConfigError for a ``--set`` without effect, and for a size of memory given two ways.

    A key of the file that is swept as well is what other commands take, and no mistake.
    """
    if config.source is None:
        return
    swept = _swept_everywhere(config)
    _refuse_set(config.source, swept)
    for pair in SAME:
        for key, other in (pair, pair[::-1]):
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
    wheres = dict.fromkeys(where for where, _ in source.places.values() if where.startswith(SET))
    for where in wheres:
        key = where.removeprefix(SET)
        for name in swept:
            if key == name or key.startswith(f"{name}."):
                raise ConfigError(f"{name!r} is swept; set sweep.{name}", where=where)


def _given(data: object, path: tuple[str, ...]) -> bool:
    for part in path:
        data = data.get(part) if isinstance(data, dict) else None
    return data is not None
