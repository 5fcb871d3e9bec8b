"""Do finite buffers make profits fall where each PE owns less than a tenth of the scene?

    python experiments/memory/figure4.py [FOLDER]

Nebel 1998, section 4.2.2, sees the time profit of concurrent dataflow fall there and supposes that
"some messages cause wait states". Reads figure4-points.csv; if it is not there, it is simulated as
figure4.yaml says (finished simulations are kept in FOLDER, out/memory/figure4) and written. Writes
the claims F4a and F4d with each kind of memory, what was expected beside what came out, the figure.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import pandas as pd
from bounded import HERE, MS, mean, points, write_outcomes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from simmpp.common.files import Row, write_csv
from simmpp.plot.matplotlib_panels import SETTINGS, STYLES, save
from simmpp.studies.nebel98.claims_concurrent import TIME_ABOVE, TIME_BELOW, WIDENED
from simmpp.studies.nebel98.figures import NAMES

NAME = "figure4"
KEYS = ["scene", "reading", "fraction", "point", "policy"]
SCENES = ["mountain:5", "rings:1", "tetra:5", "tetra:6"]
READINGS = ["plain", "mixed"]
UNBOUNDED, SMALLEST = "unbounded", "buffers of 16 kB"
SETTINGS_OF_MEMORY = [
    UNBOUNDED,
    *("buffers of 1 MB", "buffers of 256 kB", "buffers of 64 kB", SMALLEST),
    *("1 MB a PE", "256 kB a PE", "128 kB a PE", "64 kB a PE"),
]
TICKS = (1.6, 3, 5, 10, 20, 40, 60)
TENTH, HALF, STAYS = 0.1, 0.5, 1.8
"""F4d: below a tenth of the scene profits fall, and stay above 1.8."""


def profits(table: pd.DataFrame) -> pd.DataFrame:
    """Time profits of concurrent over object dataflow: rows by scene, reading and memory, columns
    by x; missing where one of both does not fit."""
    times = table[MS].unstack("policy")
    return (times["object"] / times["concurrent"]).unstack("fraction")


def judged(table: pd.DataFrame) -> Iterator[Row]:
    """F4a and F4d with each kind of memory, as ``claims_concurrent`` judges them."""
    gains = profits(table).reset_index()
    for reading in READINGS:
        for memory in SETTINGS_OF_MEMORY:
            here = gains[(gains["reading"] == reading) & (gains["point"] == memory)]
            here = here.set_index("scene").drop(columns=["reading", "point"]).loc[SCENES]
            here = here.dropna(axis=1, how="all")
            first = here.bfill(axis=1).iloc[:, 0]
            falls, stays = first < here.max(axis=1), first >= STAYS
            yield {
                "reading": reading,
                "memory": memory,
                "cases of F4a": int(in_band(here).sum().sum()),
                "of": int(here.notna().sum().sum()),
                "scenes that fall": int(falls.sum()),
                "stay above 1.8": int(stays.sum()),
                "both": int((falls & stays).sum()),
                **{f"profit at {x:.3g}": round(mean(here[x].dropna()), 3) for x in here},
            }


def in_band(gains: pd.DataFrame) -> pd.DataFrame:
    """Whether each profit is in F4a's band, which is another one from half of the scene on."""
    bands = [TIME_BELOW if float(str(x)) < HALF else TIME_ABOVE for x in gains]
    low, high = ([band[end] for band in bands] for end in (0, 1))
    return gains.ge([x * (1 - WIDENED) for x in low]) & gains.le([x * (1 + WIDENED) for x in high])


def found(table: pd.DataFrame, rows: list[Row]) -> dict[str, float]:
    """The quantities that something was expected of."""
    by = {(row["reading"], row["memory"]): row for row in rows}
    gains = profits(table)
    low = gains.columns.min()
    bends = (gains[low] / gains[TENTH]).unstack("point")
    cases = {
        memory: sum(by[reading, memory]["cases of F4a"] for reading in READINGS)
        for memory in (UNBOUNDED, SMALLEST)
    }
    lacks = table["lacks_credit"].xs((low, SMALLEST), level=("fraction", "point"))
    falls = "scenes that fall"
    return {
        "scenes that fall, mixed, unbounded memory": by["mixed", UNBOUNDED][falls],
        "scenes that fall, mixed, buffers of 16 kB": by["mixed", SMALLEST][falls],
        "scenes that fall, plain, unbounded memory": by["plain", UNBOUNDED][falls],
        "scenes that fall, plain, buffers of 16 kB": by["plain", SMALLEST][falls],
        "settings of both readings in which F4d holds (all scenes fall and stay above 1.8)": sum(
            row["both"] == len(SCENES) for row in rows
        ),
        "profit at 1/64 over that at 10 %, buffers of 16 kB over unbounded memory": mean(
            bends[SMALLEST] / bends[UNBOUNDED]
        ),
        "profit at 1/64 over that at 10 %, 128 kB a PE over unbounded memory": mean(
            (bends["128 kB a PE"] / bends[UNBOUNDED]).dropna()
        ),
        "cases of F4a, buffers of 16 kB less unbounded memory (of 56)": cases[SMALLEST]
        - cases[UNBOUNDED],
        "share of the time in which a PE of concurrent dataflow lacks credit, x = 1/64, 16 kB": (
            float(lacks.xs("concurrent", level="policy").mean())
        ),
    }


def draw(table: pd.DataFrame) -> None:
    """Time profit over x: a row for each reading, a panel for a scene, a curve for each memory."""
    gains = profits(table)
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(12, 5.8), layout="constrained")
        grid = figure.subplots(len(READINGS), len(SCENES), sharex=True, sharey="row")
        for row, reading in zip(grid, READINGS, strict=True):
            for axes, scene in zip(row, SCENES, strict=True):
                for number, memory in enumerate(SETTINGS_OF_MEMORY):
                    curve = gains.xs((scene, reading, memory))
                    style = {"color": STYLES[(number + 3) % 4]["color"], "linewidth": 1.0}
                    style["linestyle"] = "--" if "buffers" in memory else "-"
                    if memory == UNBOUNDED:
                        style = {"color": "black", "linewidth": 2.0}
                    axes.plot(100 * curve.index, curve, label=memory, **style)
                axes.axhline(STAYS, color="0.6", linewidth=0.6)
                axes.set(xscale="log", title=f"{NAMES[scene]}, {reading}")
                axes.set_xticks(
                    [1.6, 3, 5, 10, 20, 40, 60], ["1.6", "3", "5", "10", "20", "40", "60"]
                )
                axes.xaxis.set_minor_locator(NullLocator())
            row[0].set_ylabel("time profit, concurrent")
        for axes in grid[-1]:
            axes.set_xlabel("x (% of the scene)")
        handles, labels = grid[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5)
        save(figure, HERE / NAME)


def main() -> None:
    """Simulate what isn't there; write tables and figure."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else f"out/memory/{NAME}")
    table = points(NAME, KEYS, folder)
    rows = list(judged(table))
    write_csv(rows, list(rows[0]), HERE / f"{NAME}-summary.csv")
    write_outcomes(found(table, rows), NAME)
    draw(table)


if __name__ == "__main__":
    main()
