"""How much of concurrent dataflow's gain comes from load information, and how old may it be?

    python experiments/loadinfo/loadinfo.py [FOLDER]

Runs the sweep of loadinfo.yaml (finished simulations are kept in FOLDER, out/loadinfo), writes its
rows, a summary per scene and half of x, and the figure, and prints the summary.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from shutil import copyfile
from statistics import fmean
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from simmpp.common.files import write_csv
from simmpp.plot.matplotlib_panels import SETTINGS, STYLES, save
from simmpp.run.rows import RESULTS
from simmpp.studies.nebel98.figures import NAMES
from simmpp.sweeps.ratios import MAKESPAN, MESSAGES, RowIndex, mean
from simmpp.sweeps.sweep import run_sweep

HERE = Path(__file__).parent
SCENES = ("mountain:5", "rings:1", "tetra:5", "tetra:6")
PROCESSORS = 64
INFORMATION = {
    "concurrent": "with messages (the paper)",
    "refresh 100 ms": "refreshed after 100 ms",
    "refresh 10 ms": "refreshed after 10 ms",
    "refresh 1 ms": "refreshed after 1 ms",
    "exact": "exact (oracle)",
    "none": "none",
}
"""Labels of policies, and what they are called."""
HALVES = {"x < 50 %": (0.0, 0.5), "x >= 50 %": (0.5, 1.0)}

Row = dict[str, Any]


def summary(measured: RowIndex) -> Iterable[Row]:
    """Mean profits over the fractions of each half, and the share of the gain without loads."""
    for scene in SCENES:
        for half, (low, high) in HALVES.items():
            xs = [x for x in measured.fractions if low <= x < high]
            for label in INFORMATION:
                row: Row = {"scene": scene, "x": half, "load_info": label}
                for name, column in (("time", MAKESPAN), ("message", MESSAGES)):
                    profits = [
                        mean(measured.profit(column, scene, PROCESSORS, x, label)) for x in xs
                    ]
                    row[f"{name}_profit"] = round(fmean(profits), 3)
                yield row


def draw(measured: RowIndex) -> None:
    """Time profit over x, a panel per scene."""
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(9.5, 7), layout="constrained")
        grid = figure.subplots(2, 2, sharex=True)
        for axes, scene in zip(grid.flat, SCENES, strict=True):
            draw_scene(axes, measured, scene)
        for axes in grid[1]:
            axes.set_xlabel("objects resident on each PE (% of the scene)")
        for axes in grid[:, 0]:
            axes.set_ylabel("time profit over object dataflow")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        title = f"load information (lines: means of {measured.seeds} seeds; bands: their range)"
        figure.legend(handles, labels, loc="outside lower center", ncols=3, title=title)
        save(figure, HERE / "loadinfo")


def draw_scene(axes: Axes, measured: RowIndex, scene: str) -> None:
    """One panel."""
    across = [100 * x for x in measured.fractions]
    for (label, name), style in zip(INFORMATION.items(), STYLES, strict=False):
        seeds = [measured.profit(MAKESPAN, scene, PROCESSORS, x, label) for x in measured.fractions]
        low, high = [min(each) for each in seeds], [max(each) for each in seeds]
        axes.fill_between(across, low, high, color=style["color"], alpha=0.15, linewidth=0)
        axes.plot(across, [*map(fmean, seeds)], label=name, linewidth=1.3, markersize=4, **style)
    axes.axhline(1, color="black", linewidth=0.7)
    axes.set_ylim(bottom=0)
    axes.set_title(NAMES[scene], fontsize=9)
    axes.grid(linewidth=0.3, color="0.8")


def main() -> None:
    """Simulate what isn't finished; write rows, summary and figure."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/loadinfo")
    result = run_sweep(HERE / "loadinfo.yaml", out=folder)
    copyfile(folder / RESULTS, HERE / "loadinfo.csv")
    measured = RowIndex(
        {str(column): cell for column, cell in row.items()}
        for row in result.rows.fillna({"error": ""}).to_dict("records")
    )
    rows = list(summary(measured))
    write_csv(rows, list(rows[0]), HERE / "summary.csv")
    for row in rows:
        print(*row.values(), sep="\t")
    draw(measured)


if __name__ == "__main__":
    main()
