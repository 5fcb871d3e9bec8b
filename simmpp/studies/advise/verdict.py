"""From costs to advice: what is best, how sure that is, and what comes next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from simmpp.studies.advise.confidence import LEAST_SEEDS, Floats, weighted_means
from simmpp.studies.advise.racing import CONFIDENCE, Race

EQUAL = 0.01
"""What is within a hundredth of the best is as good: then the fewest nodes and the simplest setup
are advised. ESTIMATE: less than a machine's constants are known to."""

Order = tuple[int, int, str]
"""Nodes, and how simple: what is advised among equals."""


@dataclass(frozen=True)
class Verdict:
    """What came out of a race, also of one that was broken off."""

    chosen: int | None
    """The candidate that is advised; None if none came to an end."""
    ties: list[int]
    """Others that are within the indifference of the best, the best first."""
    is_within: bool
    """With a limit: it is kept."""
    sure: float | None
    """How likely no other is better by more than the indifference, or that the limit is kept, and
    not with fewer nodes; None with too few seeds."""
    likely: dict[int, float] = field(default_factory=dict)
    """For each that was left, how likely it is as good as the best."""
    regret: dict[int, float] = field(default_factory=dict)
    """For each of them, by what share more than the best it takes in the mean of all draws."""


@dataclass(eq=False)
class Contest:
    """Decides for a goal: the least cost, or the least nodes within a limit."""

    race: Race
    orders: Sequence[Order]
    limit: float = math.inf
    _lost: list[int] = field(default_factory=list)
    """Finalists with fewer nodes than those now racing."""

    def run(self) -> None:
        """Race all, or sizes one after the other until one keeps the limit."""
        race, everyone = self.race, range(len(self.orders))
        if math.isinf(self.limit):
            race.run(everyone)
            return
        most = self.limit * (1 + race.indifference)
        for size in sorted({order[0] for order in self.orders}):
            self._lost += race.in_race
            hopeful = [n for n in everyone if self.orders[n][0] == size]
            race.dropped += [n for n in hopeful if race.contenders[n].bound > most]
            race.run([n for n in hopeful if race.contenders[n].bound <= most], most)
            if race.in_race and race.mean(race.in_race[0]) <= self.limit:
                return

    def verdict(self) -> Verdict:
        """As it stands."""
        race = self.race
        ended = [n for n in self._left() if math.isfinite(race.mean(n))]
        if not ended:
            return Verdict(None, [], False, None)
        best = min(map(race.mean, ended))
        chosen = self._simplest(ended, best)
        ties = [n for n in ended if n != chosen and race.mean(n) <= best * (1 + race.indifference)]
        ties.sort(key=race.mean)
        is_within = race.mean(chosen) <= self.limit
        known = [n for n in ended if race.seeds(n) >= LEAST_SEEDS]
        if chosen not in known or not race.is_over:
            return Verdict(chosen, ties, is_within, None)
        means = weighted_means([race.of(n, LEAST_SEEDS) for n in known])
        least = means.min(axis=0)
        good = means <= least * (1 + race.indifference)
        likely = dict(zip(known, good.mean(axis=1).tolist(), strict=True))
        regret = dict(zip(known, (means / least - 1).mean(axis=1).tolist(), strict=True))
        sure = likely[chosen]
        if math.isfinite(self.limit):
            sure = self._sure_of_limit(means[known.index(chosen)])
        if any(race.contenders[n].is_drawn for n in known):
            sure = min(sure, CONFIDENCE)  # as those that left may have done so by mistake
        return Verdict(chosen, ties, is_within, sure, likely, regret)

    def _left(self) -> list[int]:
        """Those of whom one is advised: who is left, or, when broken off, all that were run."""
        if self.race.is_over:
            return self.race.in_race or self._lost
        within = [n for n in self.race.costs if self.race.mean(n) <= self.limit]
        if math.isfinite(self.limit) and within:
            least = min(self.orders[n][0] for n in within)
            return [n for n in within if self.orders[n][0] == least]
        return list(self.race.costs)

    def _simplest(self, ended: list[int], best: float) -> int:
        """Of those that are equally good, or keep the limit as well as the best."""
        equal = [n for n in ended if self.race.mean(n) <= best * (1 + EQUAL)]
        return min(equal, key=lambda n: self.orders[n])

    def _sure_of_limit(self, means: Floats) -> float:
        """How likely the limit is kept, and by nothing with fewer nodes, but for indifference."""
        race, slack = self.race, 1 + self.race.indifference
        good = means <= self.limit * slack
        lost = [n for n in self._lost if n in race.costs and race.seeds(n) >= LEAST_SEEDS]
        if lost:
            fewer = weighted_means([race.of(n, LEAST_SEEDS) for n in lost]).min(axis=0)
            good &= fewer > self.limit / slack
        return float(good.mean())
