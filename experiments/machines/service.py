"""Figures 3 and 4 with one-sided messages: who serves requests on a T3E?

    python experiments/machines/service.py

Figure 4's scenes on 64 PEs and figure 3's, Tetrahedron5, on 8 and 128 as well, each dataflow on the
paper's machine and on ``t3e-shmem`` with each service: 256 x 256 pixels, depth 5, seed 0, all as
the reading plain. Writes service.csv, a row for each run, unless it is there, and prints what
README.md says of it.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from fractions import Fraction
from pathlib import Path

import numpy as np

from simmpp.common.files import write_csv
from simmpp.engine.simulate import simulate
from simmpp.machine.presets import machine
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene

TABLE = Path(__file__).with_suffix(".csv")
MACHINES = {
    "t3e": ("t3e", "pe"),
    "shmem, pe": ("t3e-shmem", "pe"),
    "shmem, thread": ("t3e-shmem", "thread"),
    "shmem, nic": ("t3e-shmem", "nic"),
}
POLICIES = {
    "object": PolicyParameters("object"),
    "concurrent": PolicyParameters("concurrent"),
    "refreshed": PolicyParameters("concurrent", refresh_ps=10**9),
    "ray": PolicyParameters("ray"),
}
"""*refreshed* is concurrent dataflow that tells its load, or gets others', each millisecond."""
FRACTIONS = (Fraction(1, 64), *(Fraction(n, 100) for n in (5, 10, 30, 50, 80, 90)))
PLACES = {
    "mountain:5": (64,),
    "rings:1": (64,),
    "tetra:5": (8, 64, 128),
    "tetra:6": (64,),
}
COLUMNS = ("scene", "processors", "fraction", "machine", "policy", "makespan_ps", "messages")

Times = Mapping[tuple[str, int, float, str, str], int]
"""Makespans by all that a run is known by."""


def runs() -> Iterator[dict[str, object]]:
    """The rows."""
    for scene, sizes in PLACES.items():
        workload = workload_for(load_scene(scene), Picture(resolution=256))
        for processors in sizes:
            for fraction in FRACTIONS:
                placement = place(
                    workload, processors, Memory(fraction=fraction), PlacementRules(), 0
                )
                for name, (preset, service) in MACHINES.items():
                    made = machine(preset, {"service": service}, processors)
                    for policy, parameters in POLICIES.items():
                        result = simulate(workload, made, placement, parameters)
                        told = (scene, processors, float(fraction), name, policy)
                        numbers = (result.makespan_ps, result.messages)
                        yield dict(zip(COLUMNS, (*told, *numbers), strict=True))


def times() -> Times:
    """From the table."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return {
            (
                r["scene"],
                int(r["processors"]),
                float(r["fraction"]),
                r["machine"],
                r["policy"],
            ): int(r["makespan_ps"])
            for r in csv.DictReader(file)
        }


def ratios(
    of: Times,
    above: tuple[str, str],
    below: tuple[str, str],
    *,
    least: float = 0,
    most: float = 1,
    **where: object,
) -> list[float]:
    """T of one machine and policy over T of another, where ``where`` holds and x is in between."""
    found = []
    for (scene, processors, fraction, *what), time_ps in of.items():
        here = {"scene": scene, "processors": processors}
        is_there = all(here[key] == value for key, value in where.items())
        if (*what,) == above and is_there and least <= fraction <= most:
            found.append(time_ps / of[scene, processors, fraction, *below])
    return found


def told(values: list[float]) -> str:
    """Geometric mean, least and most."""
    mean = float(np.exp(np.mean(np.log(values))))
    return f"{mean:5.2f} ({min(values):.2f} to {max(values):.2f})"


def main() -> None:
    """Simulate what is not there; print."""
    if not TABLE.exists():
        write_csv(list(runs()), COLUMNS, TABLE)
    of = times()
    for one, other in (
        ("t3e", "shmem, nic"),
        ("shmem, pe", "shmem, nic"),
        ("shmem, pe", "shmem, thread"),
    ):
        for policy in POLICIES:
            few = told(ratios(of, (one, policy), (other, policy), most=0.1))
            every = told(ratios(of, (one, policy), (other, policy)))
            print(f"T({one}) / T({other}) of {policy:10}: {every}, x <= 0.1: {few}")
    for name in MACHINES:
        for scene in PLACES:
            classical = told(
                ratios(of, (name, "ray"), (name, "object"), scene=scene, processors=64)
            )
            profits = (
                told(ratios(of, (name, "object"), (name, policy), scene=scene, processors=64))
                for policy in ("concurrent", "refreshed")
            )
            print(f"{name:14} {scene:10} ray / object {classical}, profits {', '.join(profits)}")
        for processors in PLACES["tetra:5"]:
            both = (name, "ray"), (name, "object")
            found = told(ratios(of, *both, least=0.8, scene="tetra:5", processors=processors))
            print(f"{name:14} F3a {processors:4}: {found}")


if __name__ == "__main__":
    main()
