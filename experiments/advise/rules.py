"""How good an answer is, and rules of thumb that advice has to beat."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import fmean

from replay import INDIFFERENCE, Answer, Known, Question

from simmpp.studies.advise.sensitivity import DRAWS

SLACK = 1 + INDIFFERENCE
CAP = 2.0
"""Regret of what does not fit, or comes to no end: three times as long."""


def regret(question: Question, candidates: Sequence[Known], chosen: Known | None) -> float:
    """By what share more than the best it costs: time, node-seconds, or nodes where it is in time.

    A limit counts as kept, by it and by the best, with the indifference on the safe side of each.
    """
    if chosen is None or math.isinf(chosen.truth_ps):
        return CAP
    truths = [question.cost(each, each.truth_ps) for each in candidates]
    own = question.cost(chosen, chosen.truth_ps)
    if math.isinf(question.limit_ps):
        return own / min(truths) - 1
    limit = question.limit_ps
    sizes = [e.processors for e in candidates if e.truth_ps <= limit / SLACK]
    if own <= limit * SLACK:
        return max(0.0, chosen.processors / min(sizes) - 1) if sizes else 0.0
    return own / max(limit, min(truths)) - 1


def is_right(question: Question, candidates: Sequence[Known], chosen: Known) -> bool:
    """No other is better by more than the indifference."""
    return regret(question, candidates, chosen) <= INDIFFERENCE


def rights_with_other_constants(answer: Answer) -> list[bool]:
    """Likewise on each machine that the advisor did not try, as far as candidates are near."""
    chosen, question = answer.chosen, answer.question
    if chosen is None or not chosen.draws:
        return []
    found = []
    for machine in sorted(n for n in chosen.draws if n >= DRAWS):
        own = question.cost(chosen, chosen.draws[machine])
        if math.isfinite(question.limit_ps):
            found.append(own <= question.limit_ps * SLACK)
            continue
        costs = (question.cost(e, e.draws.get(machine, math.inf)) for e in answer.candidates)
        found.append(own <= min(costs) * SLACK)
    return found


# --- what it has to beat ---


def regret_of_best(question: Question, everyone: Sequence[Known], chosen: list[Known]) -> float:
    """The least regret of some candidates: who follows a rule may choose the nodes in hindsight."""
    return min((regret(question, everyone, each) for each in chosen), default=CAP)


def setups_of(everyone: Sequence[Sequence[Known]], policy: str = "") -> list[str]:
    """Names of setups, of all policies or of one."""
    return sorted({e.setup for of in everyone for e in of if policy in ("", e.policy)})


def baselines(answers: Sequence[Answer]) -> dict[str, float]:
    """Mean regret of each rule, with the setup for it that is best in hindsight."""
    asked = [(answer.question, answer.candidates) for answer in answers]
    everyone = [candidates for _, candidates in asked]

    def of(setup: str, first: str = "") -> float:
        total = []
        for question, candidates in asked:
            chosen = [e for e in candidates if e.setup == first]
            chosen = chosen or [e for e in candidates if e.setup == setup]
            total.append(min(CAP, regret_of_best(question, candidates, chosen)))
        return fmean(total)

    return {
        "always concurrent": min(map(of, setups_of(everyone, "concurrent"))),
        "always object": min(map(of, setups_of(everyone, "object"))),
        "replicated if it fits and else ray": min(
            of(setup, "replicated") for setup in setups_of(everyone, "ray")
        ),
        "the paper's model": fmean(min(CAP, regret(q, e, _by_model(q, e))) for q, e in asked),
        "the best single setup": min(map(of, setups_of(everyone))),
    }


def _by_model(question: Question, candidates: Sequence[Known]) -> Known | None:
    """Object or ray dataflow, and the number of nodes, by the paper's formulas."""
    known = [e for e in candidates if e.setup in ("object", "ray")]
    within = [e for e in known if e.model_ps <= question.limit_ps]
    if math.isfinite(question.limit_ps) and within:
        least = min(e.processors for e in within)
        known = [e for e in within if e.processors == least]
    return min(known, key=lambda e: question.cost(e, e.model_ps), default=None)
