"""How many of the paper's claims hold with other constants and readings, one set for all scenes?

    python experiments/calibration/calibration.py [FOLDER]

Simulates figures 3, 4 and 6 of Nebel 1998 (256 x 256, one seed) for every choice of choices.py and
judges the claims by the package's own predicates. Writes calibration.csv (a row per choice),
details.csv (what was simulated, by choice and claim) and the figure. Finished simulations are kept
in FOLDER (out/calibration): a second call continues.
"""

from __future__ import annotations

import csv
import sys
from contextlib import closing
from pathlib import Path

from choices import DEFAULT, FULL, SEVERAL, SINGLE, Choice
from table import draw

from simmpp.common.files import write_csv
from simmpp.common.folders import claimed
from simmpp.run.provenance import result_versions
from simmpp.studies.nebel98.claims import judge
from simmpp.studies.nebel98.evidence import Evidence
from simmpp.studies.nebel98.reproduce import load_experiment
from simmpp.studies.nebel98.verdict import DOES_NOT, HOLDS, IN_PART, Verdict
from simmpp.sweeps.journal import Journal, Outcome
from simmpp.sweeps.plan import Plan, plan_of
from simmpp.sweeps.ratios import RowIndex
from simmpp.sweeps.sweep import run_plans

HERE = Path(__file__).parent
PUBLISHED = HERE.parent / "nebel98" / "claims.csv"
"""The default at full fidelity."""
FIGURES = ("figure3", "figure4", "figure6")
SEEDS = "[0]"

CLAIMS = ("F3a", "F3b", "F3c", "F4a", "F4b", "F4c", "F4d", "F5a", "F6a", "T1", "T2")
"""Those about what is simulated; F2a and F2b are about the analytical model."""
WORDS = (HOLDS, IN_PART, DOES_NOT)

Row = dict[str, str | int]


def plans_of(choice: Choice) -> dict[str, Plan]:
    """What has to be simulated for each figure."""
    size = [f"picture.resolution={choice.resolution}", f"seeds={SEEDS}"]
    return {name: plan_of(load_experiment(name, [*size, *choice.sets])) for name in FIGURES}


def verdicts(plans: dict[str, Plan], outcomes: dict[str, Outcome]) -> list[Verdict]:
    """The claims about what is simulated, judged on a choice's own rows."""
    return judge(Evidence(*(RowIndex(plans[name].rows(outcomes)) for name in FIGURES)))


def row_of(choice: Choice, judged: list[Verdict]) -> Row:
    """A row of calibration.csv."""
    words = {each.claim: each.holds for each in judged}
    counts = {f"n_{word.replace(' ', '_')}": [*words.values()].count(word) for word in WORDS}
    return {
        "choice": choice.name,
        "kind": choice.kind,
        "set": "; ".join(choice.sets),
        **words,
        **counts,
    }


def details_of(choice: Choice, judged: list[Verdict]) -> list[Row]:
    """Rows of details.csv."""
    return [
        {
            "choice": choice.name,
            "claim": each.claim,
            "holds": each.holds,
            "simulated": each.simulated,
        }
        for each in judged
    ]


def published() -> Row:
    """The default at full fidelity, from the experiment that reproduces the paper."""
    with open(PUBLISHED, encoding="utf-8", newline="") as file:
        judged = [Verdict(**row) for row in csv.DictReader(file) if row["claim"] in CLAIMS]
    return row_of(Choice("default, 512 x 512, 8 seeds", "default"), judged)


def write(rows: list[Row], name: str) -> None:
    """Write rows as CSV beside this script."""
    write_csv(rows, list(rows[0]), HERE / name)


def main() -> None:
    """Simulate, judge and write, choice by choice, so that it can be stopped; then draw."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/calibration")
    rows: list[Row] = []
    details: list[Row] = []
    with (
        claimed(folder, "calibration"),
        closing(Journal(folder, {"versions": result_versions()})) as journal,
    ):
        for choice in (DEFAULT, *SINGLE, *SEVERAL, *FULL):
            plans = plans_of(choice)
            run_plans(plans.values(), journal)
            judged = verdicts(plans, journal.outcomes)
            rows.append(row_of(choice, judged))
            details += details_of(choice, judged)
            print(f"{choice.name}: {rows[-1]['n_holds']} of {len(judged)} hold", flush=True)
            write([published(), *rows], "calibration.csv")
            write(details, "details.csv")
    draw([published(), *rows], CLAIMS, HERE / "calibration")


if __name__ == "__main__":
    main()
