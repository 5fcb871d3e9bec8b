"""Is the advice right, is it as sure as it says, and is it better than rules of thumb?

``python experiments/advise/judge.py`` replays the advisor against ``truth.parquet`` and writes
``answers.csv``, ``judged.csv`` beside what was expected, and the reliability diagram.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any

import numpy as np
import pandas as pd
from pairs import Pair, developed, judged
from replay import HERE, SEEDS, Answer, answered, questions
from replay import recorded as known_pairs
from rules import baselines, is_right, regret, rights_with_other_constants

from simmpp.common.files import Row, write_csv
from simmpp.plot.curves import Curve, Panel, Scale, Spread
from simmpp.plot.matplotlib_panels import draw

BINS = 5


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
        "drawn": int(any(candidates[n].is_drawn for n in verdict.likely)),
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
    drawn = [row for row in rows if row["sure"] != "" and row["drawn"]]
    if drawn:
        found["answers in which something is drawn"] = float(len(drawn))
        squares = [(row["sure"] - row["right"]) ** 2 for row in drawn]
        found["Brier score of how sure, of these"] = fmean(squares)
    return found | {f"mean regret of {name}": value for name, value in baselines(answers).items()}


def memory_kept(pairs: Sequence[Pair]) -> dict[str, float]:
    """Runs that held more than a node has, and what was told not to fit without a reason."""
    names = {pair.name for pair in pairs}
    candidates: Any = pd.read_parquet(HERE / "candidates.parquet")
    candidates = candidates[candidates["pair"].isin(names)]
    runs: Any = pd.read_parquet(HERE / "truth.parquet")
    sizes = candidates.groupby("pair")["capacity_bytes"].first()
    bounded = runs[runs["pair"].isin(names) & runs["held_bytes"].notna()]
    over = bounded["held_bytes"] > bounded["pair"].map(sizes)
    unfit = candidates[candidates["fits"] == 0]
    return {
        "runs in bounded memory": float(len(bounded)),
        "of these held more than the capacity": float(over.sum()),
        "candidates that do not fit": float(len(unfit)),
        "of these without a static sum above the capacity": float(
            (unfit["lacking_bytes"] <= 0).sum()
        ),
    }


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
        found[name] = summary(rows, answers) | memory_kept(pairs)
        print(name, pd.Series(found[name]).to_string(), sep="\n")
    with open(HERE / "expected.csv", encoding="utf-8", newline="") as file:
        expected = {row["measure"]: row for row in csv.DictReader(file)}
    better = {
        f"mean regret below that of {name}": found["judged"]["regret mean"] < value
        for measure, value in found["judged"].items()
        if (name := measure.removeprefix("mean regret of ")) != measure
    }
    over = found["judged"]["of these held more than the capacity"]
    better["every run that was told to fit held no more than the capacity"] = over == 0
    measures: list[Row] = [
        {
            "measure": measure,
            "goal": expected.get(measure, {}).get("goal", ""),
            "expected": expected.get(measure, {}).get("expected", ""),
            "judged": round(value, 5),
            "developed": round(found["developed"].get(measure, math.nan), 5),
        }
        for measure, value in found["judged"].items()
    ]
    measures += [
        {
            "measure": measure,
            "goal": expected[measure]["goal"],
            "expected": expected[measure]["expected"],
            "judged": "yes" if holds else "no",
            "developed": "",
        }
        for measure, holds in better.items()
    ]
    write_csv(measures, list(measures[0]), HERE / "judged.csv")
    write_csv(rows, list(rows[0]), HERE / "answers.csv")
    bins = list(reliability(rows))
    write_csv(bins, list(bins[0]), HERE / "reliability.csv")
    picture(bins, HERE / "reliability")


if __name__ == "__main__":
    main()
