"""Do the analytical model and the asynchronous simulation agree on who wins, and where not?

    python experiments/model/agreement.py

The workload is the model's own: every ray needs 16 tests, each of an object that is as likely as
any other. Writes agreement.csv (a row per costs, nb and x), agreement-widths.csv and the figure.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from simmpp.common.files import write_csv
from simmpp.engine.simulate import simulate
from simmpp.machine.machine import Machine
from simmpp.machine.presets import machine
from simmpp.model.analytical import RAY_MESSAGES, analytical, rays_of
from simmpp.model.border import FRACTIONS
from simmpp.model.costs import costs_of
from simmpp.model.synchronous import DATAFLOWS, synchronous
from simmpp.model.synthetic import synthetic
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload

HERE = Path(__file__).parent
RAYS, STEPS, OBJECTS = 16384, 16, 1024
PROCESSORS = (8, 16, 32, 64, 128, 256)
COPY = {"rays": {"fixed": "100 us"}}
MACHINES: dict[str, dict[str, object]] = {
    "t3e": {},
    "t3e, 100 us more to pack and to unpack a message of rays": {"pack": COPY, "unpack": COPY},
    "t3e, rays of 6 kB": {"ray_bytes": "6 kB"},
}
"""Only with the last two is the border where messages hold several rays."""
ASYNCHRONOUS = (PolicyParameters("object", merge_requests=False), PolicyParameters("ray"))
MODELS = (*RAY_MESSAGES, "synchronous")

Row = dict[str, str | int | float]


def point(workload: Workload, costs: str, on: Machine, x: Fraction) -> Row:
    """T(ray) / T(object) at one point."""
    rules = PlacementRules(owners="random")
    placement = place(workload, on.processors, Memory(x), rules, seed=0)
    row: Row = {"costs": costs, "processors": on.processors, "fraction": float(x)}
    for kind in RAY_MESSAGES:
        share = [placement.effective_fraction]
        rays = rays_of(workload)
        own = costs_of(on, workload)
        times = analytical(own, [on.processors], share, rays, ray_messages=kind)
        row[kind] = float(times.ratio[0, 0])
    stepped = [synchronous(workload, on, placement, each).makespan_ps for each in DATAFLOWS]
    row["synchronous"] = stepped[1] / stepped[0]
    ran = [
        simulate(workload, on, placement, policy, engine="compiled").makespan_ps
        for policy in ASYNCHRONOUS
    ]
    row["asynchronous"] = ran[1] / ran[0]
    return row


def widths(rows: list[Row]) -> Iterable[Row]:
    """How far from the border (ratio 1) each model still disagrees with the simulation."""
    for costs in MACHINES:
        chosen = [row for row in rows if row["costs"] == costs and row["asynchronous"] != 1.0]
        for model in MODELS:
            wrong = [row for row in chosen if wins(row, model) != wins(row, "asynchronous")]
            yield {
                "costs": costs,
                "model": model,
                "points": len(chosen),
                "agree": len(chosen) - len(wrong),
                "widest_ratio": max((away(row, model) for row in wrong), default=1.0),
                "median_error": sorted(error(row, model) for row in chosen)[len(chosen) // 2],
            }


def wins(row: Row, model: str) -> bool:
    """Object dataflow wins."""
    return float(row[model]) > 1.0


def away(row: Row, model: str) -> float:
    """The factor that the model's ratio is away from 1."""
    return math.exp(abs(math.log(float(row[model]))))


def error(row: Row, model: str) -> float:
    """The factor that the model's ratio is away from the simulation's."""
    return math.exp(abs(math.log(float(row[model]) / float(row["asynchronous"]))))


def write(rows: list[Row], name: str) -> None:
    """Write rows as CSV beside this script."""
    write_csv(rows, list(rows[0]), HERE / name)


STYLES = {
    "to-all": ("o", "#d55e00", "as the paper"),
    "after-runs": ("^", "#0072b2", "no empty messages, after runs"),
}


def draw(rows: list[Row]) -> None:
    """The simulation's ratio over the model's; in the shaded quadrants they disagree."""
    figure = Figure(figsize=(10, 4.1), layout="constrained")
    for axes, costs in zip(figure.subplots(1, len(MACHINES), sharey=True), MACHINES, strict=True):
        low, high = 0.05, 200.0
        axes.fill_between([low, 1], 1, high, color="0.9")
        axes.fill_between([1, high], low, 1, color="0.9")
        axes.plot([low, high], [low, high], color="0.5", linewidth=0.8)
        for model, (marker, colour, label) in STYLES.items():
            chosen = [row for row in rows if row["costs"] == costs]
            across, up = [row[model] for row in chosen], [row["asynchronous"] for row in chosen]
            axes.scatter(
                across, up, 14, marker=marker, facecolors="none", edgecolors=colour, label=label
            )
        axes.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high), aspect="equal")
        axes.tick_params(labelsize=8)
        axes.set_title(costs.replace(" to unpack", "\nto unpack"), fontsize=8)
        axes.set_xlabel("T(ray) / T(object), model", fontsize=8)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator())
            axis.set_minor_formatter(NullFormatter())
    figure.axes[0].set_ylabel("T(ray) / T(object), asynchronous simulation", fontsize=8)
    figure.axes[0].legend(fontsize=7, loc="upper left", title="messages of rays", title_fontsize=7)
    with matplotlib.rc_context({"svg.hashsalt": "simmpp", "svg.fonttype": "none"}):
        figure.savefig(HERE / "agreement.png", dpi=200)
        figure.savefig(HERE / "agreement.svg", metadata={"Date": None})


def main() -> None:
    """Simulate the grid; write rows, widths and the figure."""
    workload = synthetic(RAYS, STEPS, OBJECTS)
    rows = [
        point(workload, costs, machine("t3e", overrides, nb), x)
        for costs, overrides in MACHINES.items()
        for nb in PROCESSORS
        for x in FRACTIONS
        if x * nb >= 1 and x < 1
    ]
    write(rows, "agreement.csv")
    summary = list(widths(rows))
    write(summary, "agreement-widths.csv")
    for row in summary:
        print(row)
    draw(rows)


if __name__ == "__main__":
    main()
