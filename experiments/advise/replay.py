"""The advisor's answers, replayed against what was recorded of all candidates.

The race, the verdict and the tries with other constants are those of the package; only what
simulates is a table. A question is a pair, some of its numbers of nodes, and a goal.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean
from typing import Any

import pandas as pd

from simmpp.studies.advise.racing import Ask, Contender, Race
from simmpp.studies.advise.sensitivity import DRAWS, Study, Values, rivals_of
from simmpp.studies.advise.setups import BY_NAME, rank
from simmpp.studies.advise.verdict import Contest, Verdict

HERE = Path(__file__).parent
INDIFFERENCE = 0.05
LISTS = ((4, 16, 64), (4, 16), (16, 64), (4,), (16,), (64,))
NODE_SECONDS = "node-seconds"
LOOSER = 1.1
"""Limits of time, by the best of the fewest and of the most nodes."""
SEEDS = 8
"""The advisor's; the truth has the others."""


@dataclass(eq=False)
class Known:
    """What was recorded of one candidate of a pair."""

    setup: str
    policy: str
    processors: int
    is_drawn: bool
    bound_ps: float
    model_ps: float
    seeds: dict[int, float] = field(default_factory=dict)
    draws: dict[int, float] = field(default_factory=dict)

    @property
    def order(self) -> tuple[int, int, str]:
        """Fewest nodes first, then the simplest."""
        return self.processors, rank(BY_NAME[self.setup]), self.setup

    @property
    def truth_ps(self) -> float:
        """Mean over seeds that the advisor does not see."""
        return (
            fmean(self.seeds[s] for s in range(SEEDS, 2 * SEEDS))
            if self.is_drawn
            else self.seeds[0]
        )


@dataclass(frozen=True)
class Question:
    """What is asked about a pair."""

    pair: str
    sizes: tuple[int, ...]
    goal: str
    limit_ps: float = math.inf

    def cost(self, candidate: Known, makespan_ps: float) -> float:
        """What is to be least."""
        return makespan_ps * (candidate.processors if self.goal == NODE_SECONDS else 1)


@dataclass(frozen=True, eq=False)
class Answer:
    """What the advisor said."""

    question: Question
    candidates: list[Known]
    verdict: Verdict
    kept: float | None
    runs: int

    @property
    def chosen(self) -> Known | None:
        """The candidate that is advised."""
        return None if self.verdict.chosen is None else self.candidates[self.verdict.chosen]


def recorded() -> dict[str, list[Known]]:
    """By pair, the candidates that fit."""
    known: dict[str, list[Known]] = {}
    table: Any = pd.read_parquet(HERE / "candidates.parquet")
    for row in table[table["fits"] == 1].itertuples():
        model = math.inf if pd.isna(row.model_ps) else row.model_ps
        about = Known(
            row.setup, row.policy, row.processors, bool(row.is_drawn), row.bound_ps, model
        )
        known.setdefault(row.pair, []).append(about)
    runs: Any = pd.read_parquet(HERE / "truth.parquet")
    for row in runs.itertuples():
        makespan = math.inf if pd.isna(row.makespan_ps) else float(row.makespan_ps)
        about = known[row.pair][row.number]
        if row.draw < 0:
            about.seeds[row.seed] = makespan
        else:
            about.draws[row.draw] = makespan
    return known


def questions(pair: str, candidates: Sequence[Known]) -> Iterator[Question]:
    """Those about a pair: goals and lists of numbers of nodes, where something fits."""
    for sizes in LISTS:
        fitting = [each for each in candidates if each.processors in sizes]
        if not any(math.isfinite(each.truth_ps) for each in fitting):
            continue
        yield Question(pair, sizes, "time")
        yield Question(pair, sizes, NODE_SECONDS)
        if len(sizes) > 1:
            for size in (sizes[0], sizes[-1]):
                best = min((e.truth_ps for e in fitting if e.processors == size), default=math.inf)
                if math.isfinite(best):
                    yield Question(pair, sizes, f"within, {size}", LOOSER * best)


def answered(question: Question, everyone: Sequence[Known]) -> Answer:
    """What the advisor says."""
    candidates = [each for each in everyone if each.processors in question.sizes]
    asked: list[Ask] = []

    def measure(asks: Sequence[Ask]) -> Iterator[tuple[Ask, float]]:
        asked.extend(asks)
        for n, seed in asks:
            yield (n, seed), question.cost(candidates[n], candidates[n].seeds[seed])

    contenders = [Contender(question.cost(e, e.bound_ps), e.is_drawn) for e in candidates]
    race = Race(contenders, measure, INDIFFERENCE)
    contest = Contest(race, [each.order for each in candidates], question.limit_ps)
    contest.run()
    verdict = contest.verdict()
    kept = None if verdict.chosen is None else _kept(question, candidates, race, verdict.chosen)
    return Answer(question, candidates, verdict, kept, len(asked))


def _kept(question: Question, candidates: Sequence[Known], race: Race, chosen: int) -> float | None:
    """On which share of machines with other constants it stays the best."""
    others: list[int] = []
    if math.isinf(question.limit_ps):
        ended = [n for n in race.costs if n != chosen and math.isfinite(race.mean(n))]
        others = sorted(ended, key=lambda n: (race.mean(n), candidates[n].order))
    rivals = rivals_of(chosen, others, [(e.policy, e.processors) for e in candidates])

    def measure(machines: Sequence[Values], numbers: Sequence[int]) -> list[list[float]]:
        if len(machines) == 1:
            return [[question.cost(candidates[n], candidates[n].seeds[0]) for n in numbers]]
        return [
            [question.cost(candidates[n], candidates[n].draws.get(draw, math.inf)) for n in numbers]
            for draw in range(DRAWS)
        ]

    if not candidates[chosen].draws:
        return None
    study = Study(chosen, rivals, measure, INDIFFERENCE, question.limit_ps)
    study.draw([{}] * DRAWS)
    return study.result().kept
