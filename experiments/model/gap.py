"""How far is the analytical model from the asynchronous simulation of real scenes?

    python experiments/model/gap.py

The four scenes of the paper, 512 x 512, depth 5, 64 PEs of the t3e preset, one seed. Writes
gap.csv, a row per scene, x and dataflow; times of models are divided by the simulation's.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from simmpp.common.files import write_csv
from simmpp.engine.simulate import simulate
from simmpp.machine.presets import machine
from simmpp.model.analytical import analytical, rays_of
from simmpp.model.costs import costs_of
from simmpp.model.measured import measured
from simmpp.model.synchronous import DATAFLOWS, Dataflow, synchronous
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.plot.curves import Curve, Panel, Scale, Spread
from simmpp.plot.matplotlib_panels import draw
from simmpp.policy.parameters import PolicyParameters
from simmpp.studies.nebel98.figures import NAMES
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.workload import Workload

HERE = Path(__file__).parent
SCENES = ("mountain:5", "rings:1", "tetra:5", "tetra:6")
PROCESSORS = 64
MACHINE = machine("t3e", {}, PROCESSORS)
FRACTIONS = (Fraction(1, 20), Fraction(1, 5), Fraction(1, 2), Fraction(4, 5))
POLICIES: dict[Dataflow, PolicyParameters] = {
    "object": PolicyParameters("object", merge_requests=False),
    "ray": PolicyParameters("ray"),
}
"""The model's object dataflow has a request for each ray; the simulation's default merges them."""
MODELS = {
    "analytical": "r from x and nb: equation (1)",
    "after_runs": "the same without empty messages",
    "measured": "r measured",
    "measured_waits": "r measured, PEs wait for messages",
    "simulated_merged": "simulation, requests merged",
}
"""Columns of times relative to the simulation, and what they are called."""
BESIDE = 0.14
"""Models of one point stand side by side."""

Row = dict[str, str | float]


def makespans(
    workload: Workload, placement: Placement, dataflow: Dataflow
) -> dict[str, int | float]:
    """The time of one dataflow by each model and by the simulation, in ps."""
    costs, rays = costs_of(MACHINE, workload), rays_of(workload)
    share = [placement.effective_fraction]
    paper = analytical(costs, [PROCESSORS], share, rays)
    runs = analytical(costs, [PROCESSORS], share, rays, ray_messages="after-runs")
    waits = synchronous(workload, MACHINE, placement, dataflow, waits=True)

    def simulated(policy: PolicyParameters) -> int:
        return simulate(workload, MACHINE, placement, policy, engine="compiled").makespan_ps

    return {
        "analytical": float(getattr(paper, dataflow)[0, 0]),
        "after_runs": float(getattr(runs, dataflow)[0, 0]),
        "measured": measured(workload, MACHINE, placement, dataflow).makespan_ps,
        "measured_waits": waits.makespan_ps,
        "simulated": simulated(POLICIES[dataflow]),
        "simulated_merged": simulated(PolicyParameters(dataflow)),
    }


def row_of(scene: str, x: Fraction, dataflow: Dataflow, times: dict[str, int | float]) -> Row:
    """The simulation's time in ms, and the others relative to it."""
    row: Row = {"scene": scene, "fraction": float(x), "dataflow": dataflow}
    row["simulated_ms"] = times["simulated"] / 1e9
    return row | {name: times[name] / times["simulated"] for name in MODELS}


def panel(rows: list[Row], dataflow: Dataflow) -> Panel:
    """Model over simulation for each scene and x; 1 is agreement."""
    chosen = [row for row in rows if row["dataflow"] == dataflow]
    curves = []
    for number, (model, label) in enumerate(MODELS.items()):
        places = [n + BESIDE * (number - len(MODELS) // 2) for n in range(len(chosen))]
        heights = [float(row[model]) for row in chosen]
        spreads = {x: Spread(y, y, y) for x, y in zip(places, heights, strict=True)}
        curves.append(Curve(label, spreads))
    names = {float(n): f"{float(row['fraction']):.0%}" for n, row in enumerate(chosen)}
    middle = (len(FRACTIONS) - 1) / 2
    for n, scene in enumerate(SCENES):
        names[n * len(FRACTIONS) + middle] = f"\n{NAMES[scene]}"
    x = Scale("objects resident on each PE", ticks=tuple(names), names=tuple(names.values()))
    ratio = Scale("model / asynchronous simulation", is_log=True, limits=(0.025, 2.2))
    return Panel(f"{dataflow} dataflow, {PROCESSORS} PEs", x, ratio, curves, level=1)


def main() -> None:
    """Run all scenes; write rows and the figure."""
    rows: list[Row] = []
    for scene in SCENES:
        workload = workload_for(load_scene(scene), Picture())
        for x in FRACTIONS:
            placement = place(workload, PROCESSORS, Memory(x), PlacementRules(), seed=0)
            for dataflow in DATAFLOWS:
                times = makespans(workload, placement, dataflow)
                rows.append(row_of(scene, x, dataflow, times))
                print(rows[-1], flush=True)
    write_csv(rows, list(rows[0]), HERE / "gap.csv")
    draw([panel(rows, dataflow) for dataflow in DATAFLOWS], HERE / "gap")


if __name__ == "__main__":
    main()
