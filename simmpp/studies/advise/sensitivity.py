"""What the advice hangs on: constants that are known to a range, at both ends and drawn at random.

The one advised and its rivals are simulated again, on machines whose constants are elsewhere in
their ranges, with one seed that all have in common.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from simmpp.common.errors import ConfigError
from simmpp.studies.advise.candidates import Candidate
from simmpp.studies.advise.constants import (
    Constant,
    constants_of,
    drawn,
    log_ratio,
    with_constants,
)
from simmpp.studies.advise.running import Runner
from simmpp.sweeps.task import Task

RIVALS = 4
"""Others that are tried with each draw: the best with another policy or number of nodes. ESTIMATE:
rivals of one policy move with it."""
RIVALS_AT_ENDS = 2
"""Of these, those that are tried at both ends of each range."""
DRAWS = 16
"""Machines drawn from the ranges."""


@dataclass(frozen=True)
class Swing:
    """What one constant does to the advantage of the one advised, at the two ends of its range."""

    constant: Constant
    advantages: tuple[float, float]
    """Log of the best rival's cost / its own, with the constant at its least and its greatest."""
    rivals: tuple[Candidate | None, Candidate | None]
    """Who that is; None: the limit of the goal."""
    turns_at: tuple[int | None, int | None]
    """Value below, and above, which the advice would be another; None: it would not."""

    @property
    def width(self) -> float:
        """How much it moves the advantage."""
        low, high = self.advantages
        return 0.0 if low == high else abs(high - low)


@dataclass(frozen=True)
class Sensitivity:
    """Of an advice."""

    advantage: float = math.nan
    """Log of the best rival's cost / the advised one's, on the machine as it is."""
    swings: list[Swing] = field(default_factory=list)
    """The constant that moves most comes first."""
    kept: float | None = None
    """Share of the drawn machines on which no rival is better by more than the indifference."""
    n_draws: int = 0


@dataclass(eq=False)
class Study:
    """Finds it; what it has so far may be asked for whenever it is broken off."""

    chosen: Candidate
    rivals: list[Candidate]
    run: Runner
    weight: Callable[[Candidate], int]
    indifference: float
    limit: float = math.inf
    """With a goal of least nodes, what is kept or not; there are no rivals then."""
    _swings: list[Swing] = field(default_factory=list)
    _drawn: list[bool] = field(default_factory=list)
    _advantage: float = math.nan

    def work(self) -> None:
        """Simulate all of it."""
        self._advantage = self._compare([{}], self.rivals)[0][0]
        constants = constants_of(self.chosen.config)
        machines = drawn(constants, DRAWS, "advise constants")
        for advantage, _ in self._compare(machines, self.rivals):
            self._drawn.append(advantage >= -math.log(1 + self.indifference))
        few = self.rivals[:RIVALS_AT_ENDS]
        ends = [{constant: end} for constant in constants for end in (constant.low, constant.high)]
        found = self._compare(ends, few)
        for constant, low, high in zip(constants, found[::2], found[1::2], strict=True):
            self._swings.append(self._swing(constant, low, high))

    def result(self) -> Sensitivity:
        """As far as it is known."""
        n = len(self._drawn)
        kept = sum(self._drawn) / n if n else None
        swings = sorted(self._swings, key=lambda swing: (-swing.width, swing.constant.name))
        return Sensitivity(self._advantage, swings, kept, n)

    def _swing(
        self,
        constant: Constant,
        low: tuple[float, Candidate | None],
        high: tuple[float, Candidate | None],
    ) -> Swing:
        ends = (constant.low, constant.high)
        turns = [
            self._turn(constant, end, at[0]) for end, at in zip(ends, (low, high), strict=True)
        ]
        return Swing(constant, (low[0], high[0]), (low[1], high[1]), (turns[0], turns[1]))

    def _turn(self, constant: Constant, end: int, advantage: float) -> int | None:
        """Where the advantage is lost between the value and an end, on a line between both."""
        lost = -math.log(1 + self.indifference)
        if advantage >= lost or end == constant.value:
            return None
        if math.isinf(advantage) or self._advantage <= lost:
            return constant.value
        share = (self._advantage - lost) / (self._advantage - advantage)
        return replace(constant, low=constant.value, high=end).at(share)

    def _compare(
        self, machines: list[dict[Constant, int]], rivals: list[Candidate]
    ) -> list[tuple[float, Candidate | None]]:
        """On each machine the log of the best rival's cost / the chosen one's, and who that is."""
        everyone = [self.chosen, *rivals]
        tasks = [self._task(each, machine) for machine in machines for each in everyone]
        runnable = [task for task in tasks if task is not None]
        costs = iter(self.run(runnable))
        found: list[tuple[float, Candidate | None]] = []
        at = iter(tasks)
        for _ in machines:
            own, *others = (
                math.inf if task is None else next(costs) * self.weight(each)
                for each, task in zip(everyone, (next(at) for _ in everyone), strict=True)
            )
            best, rival = min(
                zip(others, rivals, strict=True),
                key=lambda pair: pair[0],
                default=(self.limit, None),
            )
            found.append((log_ratio(best, own), rival))
        return found

    def _task(self, candidate: Candidate, values: dict[Constant, int]) -> Task | None:
        """Its simulation on a changed machine; None where that machine can't be."""
        try:
            config = with_constants(candidate.config, values)
            return replace(candidate, config=config).task(0)
        except ConfigError:
            return None


def rivals_of(chosen: Candidate, others: Sequence[Candidate]) -> list[Candidate]:
    """Of candidates, the best first, those that may behave otherwise than the chosen one."""
    kinds, found = {_kind(chosen)}, list[Candidate]()
    for other in others:
        if _kind(other) not in kinds and len(found) < RIVALS:
            kinds.add(_kind(other))
            found.append(other)
    return found


def _kind(candidate: Candidate) -> tuple[str, int]:
    return candidate.policy.name, candidate.processors
