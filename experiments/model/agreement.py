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
from typing import get_args

from simmpp.common.files import write_csv
from simmpp.engine.simulate import simulate
from simmpp.machine.machine import Machine
from simmpp.machine.presets import machine
from simmpp.model.analytical import RayMessages, analytical, rays_of
from simmpp.model.border import FRACTIONS
from simmpp.model.costs import costs_of
from simmpp.model.synchronous import DATAFLOWS, synchronous
from simmpp.model.synthetic import synthetic
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.plot.curves import Curve, Panel, Scale, Spread, Stated
from simmpp.plot.matplotlib_panels import draw
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
RAY_MESSAGES: tuple[RayMessages, ...] = get_args(RayMessages)
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


LABELS = {"to-all": "as the paper", "after-runs": "no empty messages, after runs"}
"""Of messages of rays."""
LOW, HIGH = 0.05, 200.0
RATIO = Scale("T(ray) / T(object), asynchronous simulation", is_log=True, ticks=(0.1, 1, 10, 100))


def panel(rows: list[Row], costs: str) -> Panel:
    """The simulation's ratio over the model's, a line for each number of PEs."""
    curves = [
        Curve(label, points(rows, costs, model, nb))
        for model, label in LABELS.items()
        for nb in PROCESSORS
    ]
    agreement = Curve("equal", {x: Spread(x, x, x) for x in (LOW, HIGH)}, is_guide=True)
    winners = [
        Stated(LOW, 1, 1, HIGH, "another winner"),
        Stated(1, HIGH, LOW, 1, ""),
    ]
    model = Scale("T(ray) / T(object), model", is_log=True, ticks=RATIO.ticks)
    note = "each line: a number of PEs, over x"
    return Panel(costs, model, RATIO, [*curves, agreement], winners, note=note, legend="messages")


def points(rows: list[Row], costs: str, model: str, nb: int) -> dict[float, Spread]:
    """The simulation's ratio by the model's."""
    return {
        float(row[model]): Spread(*[float(row["asynchronous"])] * 3)
        for row in rows
        if (row["costs"], row["processors"]) == (costs, nb)
    }


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
    draw([panel(rows, costs) for costs in MACHINES], HERE / "agreement")


if __name__ == "__main__":
    main()
