"""The reading mixed at equal object memory: of each x half is resident, and half is kept.

    python experiments/nebel98/equal_memory.py [FOLDER [SEEDS]]

The other readings keep as many objects as are resident, so they need up to twice the memory that x
says. Simulates figures 3, 4 and 6 (finished simulations are kept in FOLDER, out/equal_memory; 2
seeds by default), judges the claims with x as what is held in all, and writes equal_memory.csv:
claims.csv of this reading. F2a and F2b, of the model, know nothing of what is kept.
"""

from __future__ import annotations

import sys
from contextlib import closing
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path

from simmpp.common.files import Row, write_csv
from simmpp.common.units import share
from simmpp.config.axes import keys_of
from simmpp.config.config import Config, with_key
from simmpp.config.defaults import READING
from simmpp.run.provenance import result_versions
from simmpp.studies.nebel98.claims import judge
from simmpp.studies.nebel98.evidence import Evidence
from simmpp.studies.nebel98.reproduce import load_experiment
from simmpp.studies.nebel98.verdict import CLAIM_COLUMNS
from simmpp.sweeps.journal import Journal
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.ratios import RowIndex
from simmpp.sweeps.sweep import run_plans

HERE = Path(__file__).parent
NAME = "mixed-equal-memory"
FRACTION = "memory.fraction"


def halved(config: Config) -> Config:
    """The same experiment with half of each fraction resident; the reading keeps as many."""
    (axis,) = (axis for axis in config.axes.values() if FRACTION in keys_of(axis))
    fractions = [Fraction(share(choice.assignments[FRACTION])) / 2 for choice in axis]
    return with_key(config, f"sweep.{FRACTION}", [str(fraction) for fraction in fractions])


def held_in_all(row: Row) -> Row:
    """The row with what is resident and kept together as its fraction."""
    return {**row, "fraction": round(2 * float(row["fraction"]), 12)}


def main(folder: Path, seeds: int) -> None:
    """Simulate, judge, write."""
    overrides = (f"{READING}=mixed", f"seeds={list(range(seeds))}")
    plans = [
        plan_of(halved(load_experiment(name, overrides)))
        for name in ("figure3", "figure4", "figure6")
    ]
    folder.mkdir(parents=True, exist_ok=True)
    with closing(Journal(folder, {"versions": result_versions()})) as journal:
        run_plans(plans, journal, workers=2)
        tables = [[held_in_all(row) for row in plan.rows(journal.outcomes)] for plan in plans]
    verdicts = judge(Evidence(*(RowIndex(table) for table in tables)))
    rows = [{READING: NAME, **asdict(verdict)} for verdict in verdicts]
    write_csv(rows, (READING, *CLAIM_COLUMNS), HERE / "equal_memory.csv")
    for verdict in verdicts:
        print(f"{verdict.claim}: {verdict.holds}: {verdict.simulated}")


if __name__ == "__main__":
    main(
        Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/equal_memory"),
        int(sys.argv[2]) if len(sys.argv) > 2 else 2,
    )
