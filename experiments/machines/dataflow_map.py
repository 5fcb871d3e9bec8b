"""Which dataflow is fastest, over the bytes of an object and how often a PE uses one it fetched?

    python experiments/machines/dataflow_map.py

Rays of ``rays.py``: 4,096 start on each PE and each meets 4 different objects, drawn at random, so
with N objects a PE uses each 16,384 / N times. PEs own their share, have nothing else at first and
keep what they fetch. Each machine is a panel, above where PEs serve requests, below where a thread
or the network does. Writes dataflow_map.csv (the time of each dataflow at
each point) but for machines that are in it, and the figure.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from simmpp.common.files import write_csv
from simmpp.engine.simulate import simulate
from simmpp.machine.machine import Machine
from simmpp.machine.presets import machine
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.plot.matplotlib_panels import SETTINGS, save
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload

sys.path.append(str(Path(__file__).parent))

from rays import random_rays

HERE = Path(__file__).parent
MACHINES = {"t3e": 16, "cpu-cluster": 16, "gpu-cluster": 16, "gpu-node": 8}
"""PEs of each."""
BY_PE, BY_NIC = "pe", "nic"
"""Who serves requests."""
SAME = {"contention": "links", "compute_startup": 0, "least_tests": 0}
"""Ports serve one at a time, or any number of gets would have the full bandwidth each; computing
has no start, or the rays of a PE would be few for a GPU."""
RAYS, EACH = 4096, 4
USES = (1, 4, 16, 64, 256, 512)
"""Of an object by a PE: rays per fetch."""
SIZES = (100, 1_000, 10_000, 100_000, 1_000_000)
"""Bytes of an object."""
POLICIES = {
    "object": ("object dataflow", "o", "#d55e00"),
    "ray": ("ray dataflow", "s", "#0072b2"),
    "concurrent": ("concurrent dataflow", "^", "#009e73"),
    "cost": ("choice by time (cost)", "D", "#cc79a7"),
}
"""How each is called and drawn: colours of Okabe and Ito, and a marker."""
MARGINS = {1.05: 18, 1.5: 40, np.inf: 75}
"""Area of a marker up to each T(second) / T(best)."""
SEED = 0

Row = dict[str, Any]


def machines() -> dict[str, Machine]:
    """By name: served by the PEs, then as the preset has it; on the T3E, by the network."""
    found = {
        f"{name}, service {BY_PE}": machine(name, {"service": BY_PE, **SAME}, nb)
        for name, nb in MACHINES.items()
    }
    for name, nb in MACHINES.items():
        own = machine(name, {}, nb).service
        service = own if own != BY_PE else BY_NIC
        found[f"{name}, service {service}"] = machine(name, {"service": service, **SAME}, nb)
    return found


def times_ps(made: Machine, workload: Workload) -> dict[str, int]:
    """Makespan of each dataflow; PEs keep whatever they fetch."""
    memory = Memory(Fraction(0), transient=workload.n_objects)
    placement = place(workload, made.processors, memory, PlacementRules(), SEED)
    return {
        f"{name}_ps": simulate(workload, made, placement, PolicyParameters(name)).makespan_ps
        for name in POLICIES
    }


def simulated(name: str, made: Machine) -> Iterator[Row]:
    """The three dataflows at every point of a machine's map."""
    for uses in USES:
        for size in SIZES:
            workload = random_rays(RAYS * made.processors, RAYS * EACH // uses, EACH, size)
            at = {"machine": name, "bytes": size, "rays_per_fetch": uses}
            yield at | times_ps(made, workload)


def draw(rows: list[Row]) -> None:
    """A panel per machine; the marker is the winner, its size by how much."""
    names = list(dict.fromkeys(row["machine"] for row in rows))
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(13, 7), layout="constrained")
        grid = figure.subplots(2, 4, sharex=True, sharey=True)
        for axes, name in zip(grid.flat, names, strict=False):
            draw_panel(axes, [row for row in rows if row["machine"] == name], name)
        for axes in [*grid.flat][len(names) :]:
            axes.remove()
        for axes in grid[1]:
            axes.set_xlabel("bytes of an object")
        for axes in grid[:, 0]:
            axes.set_ylabel("rays per fetch")
        legend(figure)
        save(figure, HERE / "dataflow_map")


def draw_panel(axes: Axes, rows: list[Row], title: str) -> None:
    """One map."""
    for name, (_, marker, colour) in POLICIES.items():
        won = [row for row in rows if order(row)[0] == name]
        areas = [area(row) for row in won]
        across, up = ([float(row[key]) for row in won] for key in ("bytes", "rays_per_fetch"))
        axes.scatter(across, up, areas, marker=marker, color=colour, linewidth=0)
    classical = [int(row["ray_ps"]) / int(row["object_ps"]) for row in rows]
    level = np.log(classical).reshape(len(USES), len(SIZES))
    axes.contour(SIZES, USES, level, [0.0], colors="black", linewidths=1.2)
    axes.set(xscale="log", yscale="log", xlim=(50, 2e6), ylim=(0.6, 900))
    axes.set_yticks(USES, map(str, USES))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_locator(NullLocator())
    axes.set_title(title, fontsize=9)


def order(row: Row) -> list[str]:
    """Policies from the fastest to the slowest; the first of equal ones counts as the faster."""
    return sorted(POLICIES, key=lambda name: int(row[f"{name}_ps"]))


def area(row: Row) -> int:
    """The marker's, by T(second) / T(best)."""
    best, second, *_ = order(row)
    margin = int(row[f"{second}_ps"]) / int(row[f"{best}_ps"])
    return next(area for bound, area in MARGINS.items() if margin <= bound)


def legend(figure: Figure) -> None:
    """Markers of policies and of margins."""
    axes = figure.axes[0]
    entries: list[Artist] = [
        axes.scatter([], [], 75, marker=marker, color=colour, label=f"{label} is fastest")
        for label, marker, colour in POLICIES.values()
    ]
    words = ("up to 5 %", "up to 50 %", "more")
    entries += [
        axes.scatter([], [], area, marker="o", color="0.6", label=f"by {word}")
        for word, area in zip(words, MARGINS.values(), strict=True)
    ]
    entries += axes.plot([], [], color="black", linewidth=1.2, label="T(ray) = T(object)")
    figure.legend(handles=entries, loc="outside lower center", ncols=4, fontsize=8)


def main() -> None:
    """Simulate the machines that are not there, write rows, draw."""
    path, rows = HERE / "dataflow_map.csv", list[Row]()
    if path.exists():
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    for name, made in machines().items():
        if name not in {row["machine"] for row in rows}:
            rows += simulated(name, made)
            write_csv(rows, list(rows[0]), path)
            print(f"{name}: done", flush=True)
    draw(rows)


if __name__ == "__main__":
    main()
