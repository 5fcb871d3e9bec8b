"""Who wins, over the size of an object in rays and the size at which a message's bytes matter?

    python experiments/sensitivity/policy_map.py

Across: bytes(object) / bytes(ray), all objects being of one size. Up: n_1/2 of the network in rays,
which is the message that takes twice its startup (startup times bandwidth, Hockney); the startup is
varied, bandwidths are the T3E's, and at the T3E's own n_1/2 both are. 64 PEs, 256 x 256 pixels, one
seed. Writes policy_map.csv (a row per scene, x and sizes: the time of each dataflow), unless it is
there, and the figure.
"""

from __future__ import annotations

import csv
from dataclasses import replace
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
from simmpp.studies.nebel98.figures import NAMES
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene

HERE = Path(__file__).parent
SCENES = ("mountain:5", "tetra:5")
FRACTIONS = (Fraction(1, 10), Fraction(1, 2))
PROCESSORS, RESOLUTION, SEED = 64, 256, 0
T3E = machine("t3e", {}, PROCESSORS)
SIZES = (1, 3, 10, 30, 100, 300, 1_000, 3_000, 10_000, 30_000, 100_000)
"""bytes(object) / bytes(ray); Nebel's objects are near 1, voxels and bricks 100 to 10^5."""
HALVES = (0.1, 0.3, 1, 3, 10, 30, 100, 300, 1_000)
"""n_1/2 in rays."""
POLICIES = {
    "object": ("object dataflow", "o", "#d55e00"),
    "ray": ("ray dataflow", "s", "#0072b2"),
    "concurrent": ("concurrent dataflow", "^", "#009e73"),
}
"""How each is called and drawn: colours of Okabe and Ito, and a marker."""
MARGINS = {1.05: 18, 1.5: 40, np.inf: 75}
"""Area of a marker up to each T(second) / T(best)."""

Row = dict[str, Any]


def seconds_per_byte(of: Machine) -> float:
    """What a byte adds to a message: packed, sent, unpacked."""
    rates = (of.pack[2].bytes_per_s, of.unpack[2].bytes_per_s)
    wire = min(of.link_bytes_per_s, of.injection_bytes_per_s)
    return sum(1 / rate for rate in (*rates, wire))


def half_rays(of: Machine) -> float:
    """n_1/2 in rays."""
    startup_s = (of.send_startup_ps + of.receive_startup_ps + of.latency_ps) / 1e12
    return startup_s / seconds_per_byte(of) / of.ray_bytes


def with_half(n_rays: float) -> Machine:
    """The T3E with its startups and its latency scaled to that n_1/2."""
    scale = n_rays / half_rays(T3E)
    names = ("send_startup_ps", "receive_startup_ps", "latency_ps")
    scaled: dict[str, Any] = {name: round(getattr(T3E, name) * scale) for name in names}
    return replace(T3E, **scaled)


def simulated() -> list[Row]:
    """The three dataflows at every point of the map."""
    rows: list[Row] = []
    for scene in SCENES:
        workload = workload_for(load_scene(scene), Picture(resolution=RESOLUTION))
        for x in FRACTIONS:
            placement = place(workload, PROCESSORS, Memory(x), PlacementRules(), SEED)
            for size in SIZES:
                same = np.full(workload.n_objects, size * T3E.ray_bytes, np.int64)
                sized = replace(workload, object_bytes=same)
                for half in HALVES:
                    row: Row = {"scene": scene, "fraction": float(x)}
                    row |= {"object_over_ray_bytes": size, "half_rays": half}
                    for name in POLICIES:
                        policy = PolicyParameters(name)
                        ran = simulate(sized, with_half(half), placement, policy)
                        row[f"{name}_ps"] = ran.makespan_ps
                    rows.append(row)
            print(f"{scene}, x = {float(x)}: done", flush=True)
    return rows


def draw(rows: list[Row]) -> None:
    """A panel per scene and fraction; the marker is the winner, its size by how much."""
    with matplotlib.rc_context(SETTINGS):
        figure = Figure(figsize=(9, 7), layout="constrained")
        grid = figure.subplots(2, 2, sharex=True, sharey=True)
        panels = [(scene, float(x)) for scene in SCENES for x in FRACTIONS]
        for axes, (scene, x) in zip(grid.flat, panels, strict=True):
            at = (scene, str(x))
            chosen = [row for row in rows if (row["scene"], row["fraction"]) == at]
            draw_panel(axes, chosen, f"{NAMES[scene]}, x = {x:.0%}")
        for axes in grid[1]:
            axes.set_xlabel("bytes(object) / bytes(ray)")
        for axes in grid[:, 0]:
            axes.set_ylabel("n$_{1/2}$: startup x bandwidth (rays)")
        legend(figure)
        save(figure, HERE / "policy_map")


def draw_panel(axes: Axes, rows: list[Row], title: str) -> None:
    """One map."""
    for name, (_, marker, colour) in POLICIES.items():
        won = [row for row in rows if order(row)[0] == name]
        areas = [area(row) for row in won]
        across, up = (
            [float(row[key]) for row in won] for key in ("object_over_ray_bytes", "half_rays")
        )
        axes.scatter(across, up, areas, marker=marker, color=colour, linewidth=0)
    classical = [int(row["ray_ps"]) / int(row["object_ps"]) for row in rows]
    level = np.log(classical).reshape(len(SIZES), len(HALVES)).T
    axes.contour(SIZES, HALVES, level, [0.0], colors="black", linewidths=1.2)
    axes.axhline(half_rays(T3E), color="0.4", linewidth=0.8, linestyle=(0, (4, 3)))
    axes.set(xscale="log", yscale="log", xlim=(0.5, 2e5), ylim=(0.06, 2e3))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_locator(NullLocator())
    axes.set_title(title, fontsize=9)


def order(row: Row) -> list[str]:
    """Policies from the fastest to the slowest; the first of equal ones counts as the faster."""
    return sorted(POLICIES, key=lambda name: int(row[f"{name}_ps"]))


def area(row: Row) -> int:
    """The marker's, by T(second) / T(best)."""
    best, second, _ = order(row)
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
    entries += axes.plot([], [], color="0.4", linewidth=0.8, dashes=(4, 3), label="n$_{1/2}$, T3E")
    figure.legend(handles=entries, loc="outside lower center", ncols=4, fontsize=8)


def main() -> None:
    """Simulate, write rows, draw."""
    path = HERE / "policy_map.csv"
    if not path.exists():
        rows = simulated()
        write_csv(rows, list(rows[0]), path)
    with open(path, encoding="utf-8", newline="") as file:
        draw(list(csv.DictReader(file)))


if __name__ == "__main__":
    main()
