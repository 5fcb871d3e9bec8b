"""A race of candidates over common seeds: bounds first, then fewer candidates with more seeds.

Everyone who may still win is run with one seed, those with the best bounds first; whoever's bound
is above what another takes is never run. Then the seeds are doubled up to eight, and before each
doubling a candidate leaves that is worse than the leader by more than the indifference, whatever
chance may do: by a paired interval over the seeds that both have, or, with one seed, by more than
seeds are known to spread. At each doubling no more than a share of all candidates stays whose seeds
differ; so a race takes at most a fifth of the runs of eight seeds for all.
Source: racing by paired differences, Maron and Moore 1994 (Hoeffding races); successive halving,
Jamieson and Talwalkar 2016.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from statistics import fmean

from simmpp.sweeps.intervals import interval

ROUNDS = (1, 2, 4, 8)
"""Seeds that a candidate has been run with after each round."""
STAY = (0.2, 0.1, 0.05)
"""Share of all candidates whose seeds differ that goes on after each round but the last: with
these the rounds take 1 + 0.2 + 2 x 0.1 + 4 x 0.05 = 1.6 runs a candidate, a fifth of eight."""
LEAST_STAY = 2
CONFIDENCE = 0.99
"""Of the paired intervals by which candidates leave."""
SPREAD = 0.10
"""By how much one seed's ratio of two may be off. ESTIMATE, from experiments/stopping: 5 % for
concurrent dataflow."""
BATCH = 8
"""Candidates that are run before bounds are looked at again, however many workers there are."""

Ask = tuple[int, int]
"""A contender's number and a seed."""
Measure = Callable[[Sequence[Ask]], Iterable[tuple[Ask, float]]]
"""Runs and says what each took as soon as it is known, infinity if it came to no end."""


@dataclass(frozen=True)
class Contender:
    """What the race knows of a candidate."""

    bound: float
    """Its cost is never less."""
    is_drawn: bool
    """Its seeds differ."""


@dataclass(eq=False)
class Race:
    """How a race stands: it may be looked at whenever it is interrupted."""

    contenders: Sequence[Contender]
    measure: Measure
    indifference: float
    costs: dict[int, dict[int, float]] = field(default_factory=dict)
    """By contender and seed, of those that were run."""
    in_race: list[int] = field(default_factory=list)
    """Those that may still be the best, the best first."""
    dropped: list[int] = field(default_factory=list)
    """Those that were not run, for their bound."""
    is_over: bool = False
    """It was not broken off."""

    def run(self, numbers: Sequence[int], limit: float = math.inf) -> None:
        """Race some of them, as long as one of them may be within the limit."""
        self.is_over = False
        waiting = sorted(numbers, key=lambda n: self.contenders[n].bound)
        n_all = len(waiting)
        self.in_race = []
        self._first_round(waiting)
        for before, seeds, stay in zip(ROUNDS[:-1], ROUNDS[1:], STAY, strict=True):
            if self.in_race and self.mean(self.in_race[0]) > limit * (1 + SPREAD):
                break
            self._leave(before, max(LEAST_STAY, math.floor(stay * n_all)))
            self._ask([(n, s) for n in self.in_race for s in range(before, seeds)])
            self._sort()
        else:
            self._leave(ROUNDS[-1], n_all)
        self.is_over = True

    def _first_round(self, waiting: list[int]) -> None:
        while waiting:
            batch, waiting = waiting[:BATCH], waiting[BATCH:]
            self._ask([(n, 0) for n in batch])
            self.in_race += [n for n in batch if 0 in self.costs.get(n, ())]
            self._sort()
            lost = {n for n in waiting if self.contenders[n].bound > self._sure_of()}
            self.dropped += [n for n in waiting if n in lost]
            waiting = [n for n in waiting if n not in lost]

    def _sure_of(self) -> float:
        """A cost above which nobody wins: the least so far, and what chance may add to it."""
        drawn = 1 + SPREAD
        return min(
            self.costs[n][0] * (drawn if self.contenders[n].is_drawn else 1) for n in self.in_race
        )

    def _ask(self, asks: list[Ask]) -> None:
        """Have what is not known yet measured; one seed stands for all where nothing is drawn."""
        drawn = [(n, seed) for n, seed in asks if seed == 0 or self.contenders[n].is_drawn]
        new = [(n, seed) for n, seed in drawn if seed not in self.costs.get(n, ())]
        if new:
            for (n, seed), cost in self.measure(new):
                self.costs.setdefault(n, {})[seed] = cost

    def _leave(self, seeds: int, most: int) -> None:
        """Whoever can't win leaves, and of those whose seeds differ all beyond the best."""
        if not self.in_race:
            return
        leader = self.in_race[0]
        stay = [n for n in self.in_race if not self._has_lost(n, leader, seeds)]
        drawn = [n for n in stay if self.contenders[n].is_drawn][:most]
        self.in_race = [n for n in stay if n in drawn or not self.contenders[n].is_drawn]

    def _has_lost(self, number: int, leader: int, seeds: int) -> bool:
        pairs = list(zip(self.of(number, seeds), self.of(leader, seeds), strict=True))
        if any(math.isinf(cost) for cost, _ in pairs):
            return number != leader
        ratios = [math.log(cost / least) for cost, least in pairs]
        apart = interval(ratios, CONFIDENCE) if seeds > 1 else None
        low = apart[0] if apart else ratios[0] - self._by_chance(number, leader)
        return low > math.log(1 + self.indifference)

    def _by_chance(self, *numbers: int) -> float:
        return SPREAD if any(self.contenders[n].is_drawn for n in numbers) else 0.0

    def of(self, number: int, seeds: int) -> list[float]:
        """Costs with the first seeds."""
        known = self.costs[number]
        return [known.get(seed, known[0]) for seed in range(seeds)]

    def mean(self, number: int) -> float:
        """Of all its seeds."""
        return fmean(self.costs[number].values())

    def seeds(self, number: int) -> int:
        """With how many it was run; as many as there are where they are all the same."""
        return len(self.costs[number]) if self.contenders[number].is_drawn else ROUNDS[-1]

    def _sort(self) -> None:
        self.in_race.sort(key=lambda n: (self.mean(n), n))
