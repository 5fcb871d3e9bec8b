"""The claims where objects kept count as memory: x/2 resident and x/2 kept, the reading mixed.

    python experiments/nebel98/equal_memory.py [FOLDER [KEY=VALUE ...]]

Simulates figures 3, 4 and 6 at half of each fraction, where as many are kept as are resident, and
judges the claims by both together: equal_memory.csv. Finished simulations are kept in FOLDER
(out/equal-memory); KEY=VALUE are as --set takes them.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict
from fractions import Fraction
from pathlib import Path

from simmpp.common.files import Row, write_csv
from simmpp.common.units import share
from simmpp.config.defaults import READING
from simmpp.run.provenance import result_versions
from simmpp.studies.nebel98.claims import judge
from simmpp.studies.nebel98.evidence import Evidence
from simmpp.studies.nebel98.reproduce import load_experiment
from simmpp.studies.nebel98.verdict import CLAIM_COLUMNS
from simmpp.sweeps.journal import Journal
from simmpp.sweeps.plan import Plan, plan_of
from simmpp.sweeps.ratios import RowIndex
from simmpp.sweeps.sweep import run_plans

HERE = Path(__file__).parent
NAME = "mixed-equal-memory"
FIGURES = ("figure3", "figure4", "figure6")
FRACTION = "sweep.memory.fraction"


def halved(figure: str, overrides: Sequence[str] = ()) -> Plan:
    """The plan of a figure at half of its fractions."""
    fractions = load_experiment(figure).settings.sweep[FRACTION.removeprefix("sweep.")]
    halves = ", ".join(str(Fraction(share(x)) / 2) for x in fractions)
    return plan_of(load_experiment(figure, [*overrides, "reading=mixed", f"{FRACTION}=[{halves}]"]))


def by_both(rows: Sequence[Row]) -> RowIndex:
    """Rows by the share that is resident and kept together."""
    return RowIndex({**row, "fraction": 2 * row["fraction"]} for row in rows)


def main(folder: Path, overrides: Sequence[str] = ()) -> None:
    """Simulate, judge, write."""
    plans = {figure: halved(figure, overrides) for figure in FIGURES}
    folder.mkdir(parents=True, exist_ok=True)
    with closing(Journal(folder, {"versions": result_versions()})) as journal:
        run_plans(plans.values(), journal, workers=2)
        measured = [by_both(plan.rows(journal.outcomes)) for plan in plans.values()]
    claims = [{READING: NAME, **asdict(verdict)} for verdict in judge(Evidence(*measured))]
    write_csv(claims, (READING, *CLAIM_COLUMNS), HERE / "equal_memory.csv")
    for claim in claims:
        print(claim["claim"], claim["holds"], claim["simulated"], sep="  ")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("out/equal-memory"), sys.argv[2:])
