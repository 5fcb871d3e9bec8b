"""Is the advice right, is it as sure as it says, and is it better than rules of thumb?

``python experiments/advise/judge.py`` replays the advisor against ``truth.parquet`` and writes
``answers.csv``, ``judged.csv`` beside what was expected, and the reliability diagram.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from statistics import fmean

import numpy as np
import pandas as pd
from pairs import developed, judged
from replay import DRAWS, HERE, INDIFFERENCE, SEEDS, Answer, Known, Question, answered, questions
from replay import recorded as known_pairs

from simmpp.common.files import Row, write_csv
from simmpp.plot.curves import Curve, Panel, Scale, Spread
from simmpp.plot.matplotlib_panels import draw

SLACK = 1 + INDIFFERENCE
CAP = 2.0
"""Regret of what does not fit, or comes to no end: three times as long."""
BINS = 5


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

Choice = Callable[[Question, Sequence[Known]], float]


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


# --- tables ---


def row_of(answer: Answer) -> Row:
    """An answer and how good it was."""
    question, chosen, verdict = answer.question, answer.chosen, answer.verdict
    candidates = answer.candidates
    rights = rights_with_other_constants(answer)
    drawn = sum(each.is_drawn for each in candidates)
    sure = "" if verdict.sure is None else round(verdict.sure, 4)
    return {
        "pair": question.pair,
        "nodes": " ".join(map(str, question.sizes)),
        "goal": question.goal,
        "advised": chosen.setup if chosen else "",
        "on": chosen.processors if chosen else "",
        "regret": round(regret(question, candidates, chosen), 5),
        "sure": sure,
        "right": int(chosen is not None and is_right(question, candidates, chosen)),
        "kept": "" if answer.kept is None else answer.kept,
        "machines": len(rights),
        "right_on": sum(rights),
        "runs": answer.runs,
        "candidates": len(candidates),
        "all_runs": SEEDS * drawn + len(candidates) - drawn,
    }


def summary(rows: Sequence[Row], answers: Sequence[Answer]) -> dict[str, float]:
    """What is judged."""
    regrets = np.array([row["regret"] for row in rows])
    claims = [(row["sure"], row["right"]) for row in rows if row["sure"] != ""]
    both = [
        (row["sure"] * row["kept"], row["right_on"] / row["machines"], row["machines"])
        for row in rows
        if row["sure"] != "" and row["kept"] != "" and row["machines"]
    ]
    squares = [k * ((1 - p) ** 2 * f + p**2 * (1 - f)) for p, f, k in both]
    found = {
        "answers": float(len(rows)),
        "regret median": float(np.median(regrets)),
        "regret 95th percentile": float(np.quantile(regrets, 0.95)),
        "regret worst": float(regrets.max()),
        "regret mean": float(regrets.mean()),
        "Brier score of how sure": fmean((p - right) ** 2 for p, right in claims),
        "Brier score with other constants": sum(squares) / sum(k for _, _, k in both),
        "share of the runs of all candidates with eight seeds": sum(r["runs"] for r in rows)
        / sum(SEEDS * r["candidates"] for r in rows),
        "share of the runs that differ": sum(r["runs"] for r in rows)
        / sum(r["all_runs"] for r in rows),
    }
    return found | {f"mean regret of {name}": value for name, value in baselines(answers).items()}


def reliability(rows: Sequence[Row]) -> Iterator[Row]:
    """By what was said, in bins: how often it was right, by chance alone and with constants."""
    said: dict[str, list[tuple[float, float, int]]] = {"by chance": [], "with constants": []}
    for row in rows:
        if row["sure"] != "":
            said["by chance"].append((row["sure"], row["right"], 1))
            if row["kept"] != "" and row["machines"]:
                share = row["right_on"] / row["machines"]
                said["with constants"].append((row["sure"] * row["kept"], share, row["machines"]))
    for kind, claims in said.items():
        for n in range(BINS):
            of = [
                c
                for c in claims
                if n / BINS <= c[0] < (n + 1) / BINS or c[0] == 1 == (n + 1) / BINS
            ]
            if of:
                weight = sum(k for _, _, k in of)
                p = sum(p * k for p, _, k in of) / weight
                right = sum(f * k for _, f, k in of) / weight
                deviation = math.sqrt(max(p * (1 - p), 1e-4) / weight)
                yield {
                    "kind": kind,
                    "from": n / BINS,
                    "to": (n + 1) / BINS,
                    "claims": weight,
                    "said": round(p, 4),
                    "right": round(right, 4),
                    "deviations": round(abs(right - p) / deviation, 2),
                }


def picture(bins: Sequence[Row], path: Path) -> None:
    """The reliability diagram."""
    curves = [
        Curve(
            kind,
            {
                row["said"]: Spread(row["right"], row["right"], row["right"])
                for row in bins
                if row["kind"] == kind
            },
            notes={row["said"]: str(row["claims"]) for row in bins if row["kind"] == kind},
        )
        for kind in dict.fromkeys(row["kind"] for row in bins)
    ]
    even = {0.0: Spread(0, 0, 0), 1.0: Spread(1, 1, 1)}
    curves.append(Curve("as sure as it says", even, is_guide=True))
    ends = (0.0, 1.0)
    x, y = Scale("how sure it says it is", limits=ends), Scale("how often it is right", limits=ends)
    draw([Panel("Is the advice as sure as it says?", x, y, curves)], path)


def main() -> None:
    """Judge the pairs that nobody looked at before; those that it was made with beside them."""
    known = known_pairs()
    found = {}
    for name, pairs in (("developed", developed()), ("judged", judged())):
        answers = [
            answered(question, known[pair.name])
            for pair in pairs
            if pair.name in known
            for question in questions(pair.name, known[pair.name])
        ]
        rows = [row_of(answer) for answer in answers]
        found[name] = summary(rows, answers)
        print(name, pd.Series(found[name]).to_string(), sep="\n")
    with open(HERE / "expected.csv", encoding="utf-8", newline="") as file:
        expected = {row["measure"]: row for row in csv.DictReader(file)}
    measures = [
        {
            "measure": measure,
            "goal": expected.get(measure, {}).get("goal", ""),
            "expected": expected.get(measure, {}).get("expected", ""),
            "judged": round(value, 5),
            "developed": round(found["developed"][measure], 5),
        }
        for measure, value in found["judged"].items()
    ]
    write_csv(measures, list(measures[0]), HERE / "judged.csv")
    write_csv(rows, list(rows[0]), HERE / "answers.csv")
    bins = list(reliability(rows))
    write_csv(bins, list(bins[0]), HERE / "reliability.csv")
    picture(bins, HERE / "reliability")


if __name__ == "__main__":
    main()
