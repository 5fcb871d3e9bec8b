"""What it costs that concurrent dataflow counts rays where half of the PEs are slower.

    simmpp sweep experiments/machines/load-in-time.yaml --out DIR
    python experiments/machines/slower_half.py DIR

Writes load-in-time.csv (means over seeds, with 95 % intervals) and the figure.
"""

from __future__ import annotations

import csv
import json
import sys
from collections import defaultdict
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from statistics import fmean
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from simmpp.common.files import write_csv
from simmpp.plot.matplotlib_panels import SETTINGS, save
from simmpp.run.profit import efficiency
from simmpp.sweeps.intervals import interval

HERE = Path(__file__).parent
STEM, BASE = "load-in-time", "concurrent"
COLOURS = {
    "object": "#d55e00", "ray": "#0072b2", "concurrent": "#009e73", "load in time": "#cc79a7"
}  # fmt: skip
Row = dict[str, Any]


def summaries(folder: Path) -> Iterator[Row]:
    """A row per machine, speed of the slower half and policy."""
    seeds: dict[tuple[str, Fraction, str], dict[str, Row]] = defaultdict(dict)
    with (folder / "results.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            names = ("makespan_ps", "compute_ps", "work_ps", "bound_ps", "processors")
            slower = Fraction(str(json.loads(row["machine.speed"])["50%"]))
            key = (row["machine.preset"], slower, row["policy"])
            seeds[key][row["seed"]] = {name: int(row[name]) for name in names}
    for (preset, slower, policy), rows in sorted(seeds.items()):
        base = seeds[preset, slower, BASE]
        gains = [base[n]["makespan_ps"] / rows[n]["makespan_ps"] for n in sorted(rows)]
        low, high = interval(gains) or (gains[0], gains[0])
        yield {
            "machine": preset,
            "slower half": str(slower),
            "policy": policy,
            "efficiency": round(fmean(map(efficiency, rows.values())), 4),
            "T(concurrent) / T": round(fmean(gains), 4),
            "low": round(low, 4),
            "high": round(high, 4),
        }


def draw(rows: list[Row]) -> None:
    """Efficiency by the speed of the slower half, a panel for each machine."""
    machines = sorted({row["machine"] for row in rows}, reverse=True)
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(8, 3.4), layout="constrained")
        panels = figure.subplots(1, len(machines), sharey=True)
        for axes, machine in zip(panels, machines, strict=True):
            for policy, colour in COLOURS.items():
                of = [row for row in rows if (row["machine"], row["policy"]) == (machine, policy)]
                x = [float(Fraction(row["slower half"])) for row in of]
                line = "--" if policy == BASE else "-"
                y = [row["efficiency"] for row in of]
                axes.plot(x, y, line, marker="o", ms=3, color=colour, label=policy)
            axes.set(title=machine, xlabel="speed of the slower half of the PEs", ylim=0)
        panels[0].set_ylabel("efficiency: bound / makespan")
        panels[0].legend(fontsize=7)
        save(figure, HERE / STEM)


def main(folder: Path) -> None:
    """Write rows, draw."""
    found = list(summaries(folder))
    write_csv(found, tuple(found[0]), HERE / f"{STEM}.csv")
    draw(found)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
