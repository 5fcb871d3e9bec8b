"""Adaptive sampling: more seeds of a point, more points of an axis, as outcomes come in.

All of it follows from the plan and the outcomes of what was asked for, in whatever order they
came: each comparison decides on its seeds when all that it asked for is finished, and axes are
refined in rounds, when all comparisons have the seeds that they need. So an interrupted sweep that
is continued ends where an uninterrupted one does. A comparison with a failed task stays as it is.

An example: tolerance 2 %, refined, x in .1, .5, .9, object and concurrent dataflow::

    begin         asks for 3 x (2 policies) x (seeds 0 to 7) = 48 tasks
    .9 is back    its 8 profits are within 2 %: settled
    .1 is back    6 % after 8 seeds: 9 times as many would do; asks for as many again, 8 to 15
    .5 is back    2.5 %: 13 seeds would do; asks for 8 to 12, and others run meanwhile
    .1 is back    5 % after 16: asks for 16 to 31, and so on until it is settled, as .5 is
    all settled   the round ends: between .1 and .5 a line is off by 4 %: asks for 8 seeds of x = .3
    .3 settled    the next round: lines are good enough everywhere, so nothing is asked for
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction

from simmpp.common.files import Row
from simmpp.policy.parameters import REFERENCE
from simmpp.sweeps.grid import Comparison
from simmpp.sweeps.journal import Outcome, Results
from simmpp.sweeps.plan import Plan, PlannedPoint
from simmpp.sweeps.profits import MEASURES, profits_of
from simmpp.sweeps.refinement import (
    FEWEST_POINTS,
    FRACTION,
    MOST_HALVINGS,
    between,
    identity,
    moved,
    refined_keys,
    too_coarse,
    value_of,
)
from simmpp.sweeps.stopping import first_seeds, seeds_in_order, seeds_wanted
from simmpp.sweeps.task import Task, task_of


@dataclass(eq=False)
class Group:
    """The points of one comparison that are asked for."""

    points: list[PlannedPoint]
    depths: dict[str, int]
    """How often axes were halved to come here, by key."""
    seeds: int
    missing: set[str] = field(default_factory=set)
    """Keys of tasks that are not finished."""
    failed: bool = False

    @property
    def comparison(self) -> Comparison:
        """What its points have in common."""
        return self.points[0].point.comparison


class AdaptiveSampler:
    """The points that are asked for, and which of them wait for outcomes.

    Its neighbour is AverageLearner1D of the package adaptive, which has neither paired ratios nor
    results that are the same in whatever order outcomes come.
    """

    def __init__(self, plan: Plan, results: Results) -> None:
        self._plan, self._results = plan, results
        self._settings, self._refined = plan.config.settings, refined_keys(plan.config)
        self._groups = _groups(plan)
        self._unsettled = set(self._groups)
        # equal points of several comparisons are one task, so an outcome may be awaited by many
        self._waiting: dict[str, list[Group]] = {}
        self._asked, self._failed = set[str](), set[str]()
        for group in self._groups:
            self._ask(group, group.points)
        self._settle(self._groups)

    @property
    def plan(self) -> Plan:
        """All points that are asked for so far."""
        return replace(self._plan, points=tuple(p for group in self._groups for p in group.points))

    @property
    def pending(self) -> list[Task]:
        """Tasks that are asked for and not finished; neighbours share what they can."""
        return [task for task in self.plan.tasks if not self._results.finished(task.key)]

    def tell(self, outcome: Outcome) -> list[Task]:
        """What an outcome, which the results have by now, makes the sweep ask for."""
        groups = self._waiting.pop(outcome.key, [])
        for group in groups:
            group.missing.discard(outcome.key)
        if outcome.error:
            self._failed.add(outcome.key)
            for group in groups:
                self._fail(group)
        return self._settle(groups)

    def _settle(self, groups: Iterable[Group]) -> list[Task]:
        """Let comparisons decide on their seeds; when all have, look at the axes."""
        tasks = [task for group in groups for task in self._advance(group)]
        # a loop, for in a continued sweep all that a round asks for may be finished already
        while not self._unsettled and (added := list(self._divided())):
            self._groups += added
            self._unsettled.update(added)
            tasks += [task for group in added for task in self._ask(group, group.points)]
            tasks += [task for group in added for task in self._advance(group)]
        return tasks

    def _advance(self, group: Group) -> Iterator[Task]:
        """Take further seeds as long as all that was asked for is there and not enough."""
        while group in self._unsettled and not group.missing:
            wanted = self._seeds_wanted(group)
            if wanted == group.seeds:
                self._unsettled.discard(group)
                return
            seeds = seeds_in_order(self._settings.seeds, wanted)[group.seeds :]
            points = _planned(group.comparison, seeds, group.points[0])
            group.points += points
            group.seeds = wanted
            yield from self._ask(group, points)

    def _ask(self, group: Group, points: Iterable[PlannedPoint]) -> list[Task]:
        """Wait for the tasks of points; returns those that nobody has asked for."""
        tasks = {point.task.key: point.task for point in points}
        missing = [key for key in tasks if not self._results.finished(key)]
        for key in missing:
            group.missing.add(key)
            self._waiting.setdefault(key, []).append(group)
        if self._failed.intersection(missing):  # another comparison has tried it
            self._fail(group)
        new = [tasks[key] for key in missing if key not in self._asked]
        self._asked.update(missing)
        return new

    def _fail(self, group: Group) -> None:
        group.failed = True
        self._unsettled.discard(group)

    def _seeds_wanted(self, group: Group) -> int:
        settings = self._settings
        if settings.tolerance is None:
            return group.seeds
        profits = self._profits(group).values()
        return seeds_wanted(profits, group.seeds, settings.tolerance, settings.max_seeds)

    def _profits(self, group: Group) -> dict[tuple[str, str], list[float]]:
        """The values of the seeds, in their order, by policy and measure; none if one is missing,
        for what does not fit into memory has no result."""
        of_policy: dict[str, list[Row]] = {}
        for planned in group.points:
            numbers = self._results.outcomes[planned.task.key].numbers
            of_policy.setdefault(planned.point.policy.title, []).append(numbers)
        references = of_policy.pop(REFERENCE)
        found = {}
        for title, runs in of_policy.items():
            both = list(zip(references, runs, strict=True))
            for measure, column in MEASURES.items():
                values = profits_of(both, column)
                found[title, measure] = values if len(values) == len(both) else []
        return found

    def _divided(self) -> Iterator[Group]:
        """New comparisons between those of a line that is too coarse."""
        known = {identity(group.comparison) for group in self._groups} if self._refined else set()
        for key in self._refined:
            lines: dict[str, list[Group]] = {}
            for group in self._groups:
                lines.setdefault(identity(group.comparison, key), []).append(group)
            for line in lines.values():
                for group in self._between(line, key):
                    if (name := identity(group.comparison)) not in known:
                        known.add(name)
                        yield group

    def _between(self, line: list[Group], key: str) -> Iterator[Group]:
        if len(line) < FEWEST_POINTS or any(group.failed for group in line):
            return
        line = sorted(line, key=lambda group: value_of(group.comparison, key))
        xs = [value_of(group.comparison, key) for group in line]
        profits = [self._profits(group) for group in line]
        curves = [[of_point[name] for of_point in profits] for name in profits[0]]
        for i in too_coarse(xs, curves, self._settings.tolerance or Fraction(1)):
            depth = 1 + max(group.depths.get(key, 0) for group in line[i : i + 2])
            value = between(xs[i], xs[i + 1], whole=key != FRACTION)
            if depth <= MOST_HALVINGS and value is not None:
                yield self._moved(line[i], key, value, depth)

    def _moved(self, beside: Group, key: str, value: Fraction, depth: int) -> Group:
        seeds = first_seeds(self._settings)
        points = _planned(moved(beside.comparison, key, value), seeds, beside.points[0])
        return Group(points, beside.depths | {key: depth}, len(seeds))


def _planned(
    comparison: Comparison, seeds: Iterable[int], like: PlannedPoint
) -> list[PlannedPoint]:
    """Points on the workload of another one."""
    return [
        PlannedPoint(point, task_of(point, like.task.digest), like.scene)
        for point in comparison.points(seeds)
    ]


def _groups(plan: Plan) -> list[Group]:
    """The points of a plan by comparison, in its order."""
    groups: dict[int, list[PlannedPoint]] = {}
    for planned in plan.points:
        groups.setdefault(id(planned.point.comparison), []).append(planned)
    return [
        Group(points, {}, len({planned.point.seed for planned in points}))
        for points in groups.values()
    ]
