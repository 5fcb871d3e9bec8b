"""What the advice hangs on: constants that are known to a range, at both ends and drawn at random.

The one advised and its rivals are simulated again, on machines whose constants are elsewhere in
their ranges, with one seed that all have in common.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from simmpp.studies.advise.constants import Constant, drawn, log_ratio

RIVALS = 4
"""Others that are tried with each draw: the best with another policy or number of nodes. ESTIMATE:
rivals of one policy move with it."""
RIVALS_AT_ENDS = 1
"""Of these, the best is tried at both ends of each range: each takes two runs a constant."""
DRAWS = 16
"""Machines drawn from the ranges."""
STREAM = "advise constants"

Values = dict[Constant, int]
"""Constants that are not as the machine has them."""
Remeasure = Callable[[Sequence[Values], Sequence[int]], list[list[float]]]
"""The cost of each of some contenders on each of some machines."""
Kind = tuple[str, int]
"""A contender's policy and number of nodes."""


@dataclass(frozen=True)
class Swing:
    """What one constant does to the advantage of the one advised, at the two ends of its range."""

    constant: Constant
    advantages: tuple[float, float]
    """Log of the best rival's cost / its own, with the constant at its least and its greatest."""
    rivals: tuple[int | None, int | None]
    """Which contender that is; None: the limit of the goal."""
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
    n_kept: int = 0
    """Of the drawn machines, those on which no rival is better by more than the indifference."""
    n_draws: int = 0

    @property
    def kept(self) -> float | None:
        """How likely that is on another machine: by the rule of succession (Laplace 1774), as few
        machines are drawn. None if none is."""
        return (self.n_kept + 1) / (self.n_draws + 2) if self.n_draws else None


@dataclass(eq=False)
class Study:
    """Finds it; what it has so far may be asked for whenever it is broken off."""

    chosen: int
    rivals: Sequence[int]
    measure: Remeasure
    indifference: float
    limit: float = math.inf
    """With a goal of least nodes, what is kept or not; there are no rivals then."""
    _swings: list[Swing] = field(default_factory=list)
    _drawn: list[bool] = field(default_factory=list)
    _advantage: float = math.nan

    def draw(self, machines: Sequence[Values]) -> None:
        """On how many machines it stays the best."""
        self._advantage = self._compare([{}], self.rivals)[0][0]
        for advantage, _ in self._compare(machines, self.rivals):
            self._drawn.append(advantage >= self._lost)

    def vary(self, constants: Sequence[Constant]) -> None:
        """Where each constant alone would change the advice."""
        ends = [{constant: end} for constant in constants for end in (constant.low, constant.high)]
        found = self._compare(ends, self.rivals[:RIVALS_AT_ENDS])
        for constant, low, high in zip(constants, found[::2], found[1::2], strict=True):
            turns_at = (
                self._turn(constant, constant.low, low[0]),
                self._turn(constant, constant.high, high[0]),
            )
            self._swings.append(Swing(constant, (low[0], high[0]), (low[1], high[1]), turns_at))

    def result(self) -> Sensitivity:
        """As far as it is known."""
        swings = sorted(self._swings, key=lambda swing: (-swing.width, swing.constant.name))
        return Sensitivity(self._advantage, swings, sum(self._drawn), len(self._drawn))

    @property
    def _lost(self) -> float:
        """An advantage below which another is better."""
        return -math.log(1 + self.indifference)

    def _turn(self, constant: Constant, end: int, advantage: float) -> int | None:
        """Where the advantage is lost between the value and an end, on a line between both."""
        if advantage >= self._lost or end == constant.value:
            return None
        if math.isinf(advantage) or self._advantage <= self._lost:
            return constant.value
        share = (self._advantage - self._lost) / (self._advantage - advantage)
        return replace(constant, low=constant.value, high=end).at(share)

    def _compare(
        self, machines: Sequence[Values], rivals: Sequence[int]
    ) -> list[tuple[float, int | None]]:
        """On each machine the log of the best rival's cost / the chosen one's, and who that is."""
        found: list[tuple[float, int | None]] = []
        for own, *others in self.measure(machines, [self.chosen, *rivals]):
            best, rival = self.limit, None
            for cost, number in zip(others, rivals, strict=True):
                if rival is None or cost < best:
                    best, rival = cost, number
            found.append((log_ratio(best, own), rival))
        return found


def rivals_of(chosen: int, others: Sequence[int], kinds: Sequence[Kind]) -> list[int]:
    """Of others, the best first, those that may behave otherwise than the chosen one."""
    seen, found = {kinds[chosen]}, list[int]()
    for other in others:
        if kinds[other] not in seen and len(found) < RIVALS:
            seen.add(kinds[other])
            found.append(other)
    return found


def machines_drawn(constants: Sequence[Constant]) -> list[Values]:
    """Those on which an advice is tried."""
    return drawn(constants, DRAWS, STREAM)
