"""From the rows of the draws to indices with their intervals, and to the figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib
import numpy as np
from factors import FACTORS, Values
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from SALib.analyze import sobol
from scipy.stats import spearmanr

from simmpp.plot.matplotlib_panels import SETTINGS
from simmpp.studies.nebel98.figures import NAMES

OUTPUTS = {
    "time_profit": ("time profit", "object_ps", "concurrent_ps"),
    "message_profit": ("message profit", "object_messages", "concurrent_messages"),
    "ray_over_object": ("T(ray) / T(object)", "ray_ps", "object_ps"),
}
"""What is explained: columns above and below."""
RESAMPLES = 1000
FIRST, TOTAL = "#0072b2", "#e69f00"

Row = Mapping[str, Any]


def logs(rows: Sequence[Row], output: str) -> NDArray[np.float64]:
    """Natural logarithms of a ratio: a factor up counts as much as a factor down."""
    _, above, below = OUTPUTS[output]
    return np.log([float(row[above]) / float(row[below]) for row in rows])


def indices(rows: Sequence[Row], problem: dict[str, Any], seed: int) -> list[dict[str, Any]]:
    """First and total index of every factor with the half-widths of their 95 % intervals.

    ``rows`` are of one scene, in the order of the draws, whole groups of a power of two.
    """
    found: list[dict[str, Any]] = []
    for output in OUTPUTS:
        values = logs(rows, output)
        result = sobol.analyze(
            problem, values, calc_second_order=False, num_resamples=RESAMPLES, seed=seed
        )
        for n, factor in enumerate(FACTORS):
            row = {"scene": rows[0]["scene"], "output": output, "factor": factor.name}
            for column in ("S1", "S1_conf", "ST", "ST_conf"):
                row[column] = round(float(result[column][n]), 4)
            found.append(row | {"sd_log": round(float(np.std(values)), 4)})
    return found


def levels(rows: Sequence[Row], values: Sequence[Values], group: int) -> list[dict[str, Any]]:
    """Means of the ratios at each level of a reading, and in each third of a range.

    Only draws that are independent of each other count: the first and the last of each group. The
    mean is the geometric one; beside it are its 95 % half-width, as a factor, and how often the
    ratio is above 1.
    """
    chosen = [row for row in rows if int(row["draw"]) % group in (0, group - 1)]
    found: list[dict[str, Any]] = []
    for factor in FACTORS:
        own = [factor.level(values[int(row["draw"])][factor.name]) for row in chosen]
        for level in sorted(set(own)):
            here = [row for row, each in zip(chosen, own, strict=True) if each == level]
            line: dict[str, Any] = {"scene": rows[0]["scene"], "factor": factor.name}
            line |= {"level": level.partition(" ")[2], "n": len(here)}
            for output in OUTPUTS:
                own_logs = logs(here, output)
                half = 1.96 * np.std(own_logs) / np.sqrt(len(here))
                line[output] = round(float(np.exp(np.mean(own_logs))), 3)
                line[f"{output}_factor"] = round(float(np.exp(half)), 3)
                line[f"{output}_above_1"] = round(float(np.mean(own_logs > 0)), 3)
            found.append(line)
    return found


def agreement(reduced: Sequence[Row], full: Sequence[Row]) -> list[str]:
    """What the reduced picture changes: rank correlation and median factor over the same draws."""
    lines: list[str] = []
    for scene in sorted({row["scene"] for row in full}):
        draws = {row["draw"]: row for row in reduced if row["scene"] == scene}
        pairs = [(draws[row["draw"]], row) for row in full if row["scene"] == scene]
        for output in OUTPUTS:
            a, b = (logs(each, output) for each in zip(*pairs, strict=True))
            ranks = spearmanr(a, b).statistic
            factor, spread = np.exp(np.median(a - b)), np.exp(np.std(a - b))
            lines.append(
                f"{scene}, {output}: {len(pairs)} draws, rank correlation {ranks:.2f}, "
                f"reduced / full {factor:.2f} (one standard deviation: a factor {spread:.2f})"
            )
    return lines


def draw(rows: Sequence[Row], scenes: Sequence[str], note: str) -> Figure:
    """A panel per scene and output; factors in the order of their largest total index."""
    largest = {
        factor.name: max(float(row["ST"]) for row in rows if row["factor"] == factor.name)
        for factor in FACTORS
    }
    order = sorted(FACTORS, key=lambda factor: largest[factor.name])
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(10, 8.6), layout="constrained")
        grid = figure.subplots(len(scenes), len(OUTPUTS), sharex=True, sharey=True)
        for line, scene in zip(grid, scenes, strict=True):
            for axes, output in zip(line, OUTPUTS, strict=True):
                own = {
                    row["factor"]: row
                    for row in rows
                    if (row["scene"], row["output"]) == (scene, output)
                }
                _bars(axes, [own[factor.name] for factor in order])
                spread = np.exp(float(own["x"]["sd_log"]))
                note = f"(one standard deviation: a factor {spread:.2f})"
                axes.set_title(f"{NAMES[scene]}: {OUTPUTS[output][0]}\n{note}", fontsize=9)
        for axes in grid[:, 0]:
            axes.set_yticks(range(len(order)), [factor.label for factor in order])
        for axes in grid[-1]:
            axes.set_xlabel("share of the variance of its logarithm")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3, title=note)
    return figure


def _bars(axes: Axes, rows: Sequence[Row]) -> None:
    """First index above, total below, with their intervals."""
    styles = {
        "S1": (0.2, FIRST, "", "first order: alone"),
        "ST": (-0.2, TOTAL, "////", "total: alone and with others"),
    }
    for column, (shift, colour, hatch, label) in styles.items():
        axes.barh(
            [n + shift for n in range(len(rows))],
            [float(row[column]) for row in rows],
            0.38,
            xerr=[float(row[f"{column}_conf"]) for row in rows],
            color=colour,
            hatch=hatch,
            edgecolor="white",
            linewidth=0,
            error_kw={"elinewidth": 0.8, "capsize": 1.5},
            label=label,
        )
    axes.set_xlim(-0.2, 1)  # an estimate of nearly nothing may be negative
    axes.axvline(0, color="black", linewidth=0.7)
    axes.grid(axis="x", linewidth=0.3, color="0.8")
    axes.set_axisbelow(True)
