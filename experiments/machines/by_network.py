"""Figures 3 and 4 of Nebel 1998, had the network of its machine served requests.

    python experiments/machines/by_network.py [FOLDER]

The reading is plain, the machine the T3E with ``service: pe`` as in the paper, or with ``nic``: an
object is fetched by a get that costs its owner nothing, rays are put. 256 x 256, seed 0; finished
simulations are kept in FOLDER (out/by_network). Writes by_network.csv, the verdicts on the claims
of both figures and of the table of messages with either, and both figures with ``nic``.
"""

from __future__ import annotations

import sys
from contextlib import closing
from dataclasses import asdict, replace
from pathlib import Path

from simmpp.common.files import Row, write_csv
from simmpp.plot.matplotlib_panels import draw
from simmpp.run.provenance import result_versions
from simmpp.studies.nebel98.claims import f3a, f3b, f3c, t1
from simmpp.studies.nebel98.claims_concurrent import f4a, f4b, f4c, f4d
from simmpp.studies.nebel98.evidence import Evidence
from simmpp.studies.nebel98.figures import FIGURES
from simmpp.studies.nebel98.reproduce import load_experiment
from simmpp.studies.nebel98.verdict import CLAIM_COLUMNS
from simmpp.sweeps.journal import Journal
from simmpp.sweeps.plan import plan_of
from simmpp.sweeps.ratios import RowIndex
from simmpp.sweeps.sweep import run_plans

HERE = Path(__file__).parent
SERVICES = ("pe", "nic")
SHOWN = ("figure3", "figure4")
CLAIMS = (f3a, f3b, f3c, t1, f4a, f4b, f4c, f4d)


def judged(folder: Path, service: str) -> list[Row]:
    """Simulate both figures and judge what is said of them."""
    overrides = (
        "reading=plain",
        "seeds=[0]",
        "picture.resolution=256",
        f"machine.service={service}",
    )
    plans = {name: plan_of(load_experiment(name, overrides)) for name in SHOWN}
    with closing(Journal(folder, {"versions": result_versions()})) as journal:
        run_plans(plans.values(), journal, workers=1)
        measured = {name: RowIndex(plan.rows(journal.outcomes)) for name, plan in plans.items()}
    if service == "nic":
        for name in SHOWN:
            panels = FIGURES[name][1](measured[name])
            noted = [replace(panel, note=f"{panel.note}; service: nic") for panel in panels]
            draw(noted, HERE / f"by_network-{name}")
    evidence = Evidence(measured["figure3"], measured["figure4"], RowIndex([]))
    return [{"service": service, **asdict(claim(evidence))} for claim in CLAIMS]


def main(folder: Path) -> None:
    """Both services."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = [row for service in SERVICES for row in judged(folder, service)]
    write_csv(rows, ("service", *CLAIM_COLUMNS), HERE / "by_network.csv")
    for row in rows:
        print(f"{row['service']}: {row['claim']}: {row['holds']}: {row['simulated']}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "out/by_network"))
