"""How stale may load information be?

    python experiments/policies/staleness.py [FOLDER]

Reads staleness-points.csv; if it is not there, runs the sweep of staleness.yaml (finished
simulations are kept in FOLDER, out/policies/staleness) and writes it. Writes the summary, what was
expected of it, and the figure.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from points import HERE, makespans, mean, with_processors, write_outcomes

from simmpp.common.files import Row, write_csv
from simmpp.plot.matplotlib_panels import SETTINGS, STYLES, save

NAME = "staleness"
SAMPLED = ("exact", "30 us", "100 us", "300 us", "1 ms", "3 ms", "10 ms", "never")
OTHERS = ("headers", "refresh", "two", "none")
DATAFLOWS = ("concurrent", "holders")


def slowdown(table: pd.DataFrame, dataflow: str, info: str) -> pd.Series:
    """Makespan with this load information over that with exact loads, at each point."""
    return table[f"{dataflow} {info}"] / table[f"{dataflow} exact"]


def found(table: pd.DataFrame) -> dict[str, float]:
    """The quantities that something was expected of."""
    means = {
        f"{dataflow} {info} / exact": mean(slowdown(table, dataflow, info))
        for dataflow in DATAFLOWS
        for info in (*SAMPLED, *OTHERS)
        if f"{dataflow} {info}" in table
    }
    late = [slowdown(table, dataflow, "1 ms") for dataflow in DATAFLOWS]
    spread = [mean(slowdown(with_processors(table, nb), "concurrent", "never")) for nb in (64, 8)]
    return means | {
        "concurrent 10 ms / never": mean(table["concurrent 10 ms"] / table["concurrent never"]),
        "holders is hurt more by 1 ms than concurrent (share of points)": float(
            (late[1] > late[0]).mean()
        ),
        "concurrent refresh / headers": mean(
            table["concurrent refresh"] / table["concurrent headers"]
        ),
        "spread of concurrent exact to never at 64 PEs over that at 8 PEs": spread[0] / spread[1],
    }


def summary(table: pd.DataFrame) -> Iterator[Row]:
    """Slowdown and time profit by scene, and of all."""
    for scene, of_scene in [*table.groupby("scene"), ("all", table)]:
        for dataflow in DATAFLOWS:
            for info in (*SAMPLED, *OTHERS):
                if (label := f"{dataflow} {info}") in table:
                    ratio = slowdown(of_scene, dataflow, info)
                    yield {
                        "scene": scene,
                        "dataflow": dataflow,
                        "load_info": info,
                        "over_exact": round(mean(ratio), 3),
                        "worst_over_exact": round(ratio.max(), 2),
                        "time_profit": round(mean(of_scene["object"] / of_scene[label]), 3),
                    }


def draw(table: pd.DataFrame) -> None:
    """Slowdown over the period of sampling: a row for each dataflow, a column for each nb."""
    numbers = sorted(set(table.index.get_level_values("processors")))
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(11, 6.5), layout="constrained")
        grid = figure.subplots(2, len(numbers), sharex=True, sharey="row")
        for row, dataflow in zip(grid, DATAFLOWS, strict=True):
            for axes, processors in zip(row, numbers, strict=True):
                draw_panel(axes, with_processors(table, processors), dataflow)
                axes.set_title(f"{dataflow}, {processors} PEs", fontsize=9)
            row[0].set_ylabel("makespan / makespan with exact loads")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        title = "residents (geometric means of nine scenes and six x)"
        figure.legend(handles, labels, loc="outside lower center", ncols=3, title=title)
        save(figure, HERE / NAME)


def draw_panel(axes: Axes, table: pd.DataFrame, dataflow: str) -> None:
    """One line for each rule of residents; what is no sample stands to its right."""
    names = (*SAMPLED, *OTHERS)
    for (residents, of_rule), style in zip(table.groupby("residents"), STYLES, strict=False):
        known = [info for info in names if f"{dataflow} {info}" in table]
        ratios = [mean(slowdown(of_rule, dataflow, info)) for info in known]
        places = [names.index(info) for info in known]
        line = {"linewidth": 1.3, "markersize": 4, **style}
        n = len(SAMPLED)
        axes.plot(places[:n], ratios[:n], label=residents, **line)
        axes.plot(places[n:], ratios[n:], **{**line, "linestyle": "none"})
    axes.axhline(1, color="black", linewidth=0.7)
    axes.axvline(len(SAMPLED) - 0.5, color="0.6", linewidth=0.7)
    axes.set_yscale("log")
    ticks = [tick for tick in (0.9, 1, 1.2, 1.5, 2, 3, 4, 6) if tick <= axes.get_ylim()[1]]
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks], minor=False)
    axes.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    axes.set_xticks(range(len(names)), names, rotation=60, fontsize=8)
    axes.grid(linewidth=0.3, color="0.8")


def main() -> None:
    """Simulate what isn't there; write summary, outcomes and figure."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else f"out/policies/{NAME}")
    table = makespans(NAME, folder)
    rows = list(summary(table))
    write_csv(rows, list(rows[0]), HERE / f"{NAME}-summary.csv")
    write_outcomes(found(table), NAME)
    draw(table)


if __name__ == "__main__":
    main()
