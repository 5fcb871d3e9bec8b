"""A model without time, as a control variate: does it know which residents make a run slow?

    python experiments/rungs/fluid.py

How often the rays of each PE's pixels test each object is counted once per scene. Residents then
say which of these tests go elsewhere, and the PE with the most work gives the makespan; nothing
happens in time. Writes fluid.csv: for the runs of rungs.py, how far that makespan is off, and its
correlation over seeds with the simulated one, whose spread would shrink by sqrt(1 - r^2). Source:
the bottleneck of a closed network of queues (Lazowska and others 1984, Quantitative System
Performance, chapter 5), with measured visits.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rungs_runs import FIGURE4, all_runs

from simmpp.common.files import write_csv
from simmpp.machine.machine import CopyCost, Machine
from simmpp.machine.messages import OBJECT, RAYS, REQUEST
from simmpp.machine.presets import machine
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, Placement, PlacementRules
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.workload import Workload

FETCHES_EXPONENT = 0.62
"""A PE that needs an object for n tests fetches it n^0.62 times, as many of the requests merge.
ESTIMATE, range 0.57-0.67: what gives the fetches of the paper's four scenes, 64 PEs, x = 1/64."""

Floats = NDArray[np.floating]
Bools = NDArray[np.bool_]

FLUIDS = ("object", "object, waiting", "ray")
"""Object dataflow whose PEs never wait, or wait out every fetch; ray dataflow."""


@dataclass(frozen=True, eq=False)
class Demand:
    """Who needs which object, and what that costs wherever it is done; P pairs (PE, object)."""

    pes: NDArray[np.int64]
    """(P,) int64: the PE whose pixels' rays test the object."""
    objects: NDArray[np.int64]
    """(P,) int64."""
    owners: NDArray[np.int64]
    """(P,) int64: owner of that object."""
    compute_ps: Floats
    """(P,) float64: all these tests."""
    moving_ps: Floats
    """(P,) float64: unpacking the ray for each of them."""
    fetching_ps: Floats
    """(P,) float64: asking for the object and receiving it, as often as it is fetched."""
    serving_ps: Floats
    """(P,) float64: the owner's part in that."""
    waiting_ps: Floats
    """(P,) float64: the network, and an owner that looks up after half a quantum."""
    home_ps: Floats
    """(nb,) float64: what a PE has to do for its pixels wherever the objects are."""

    def fluid_ps(self, held: Bools) -> Floats:
        """The makespans of ``FLUIDS`` if the PE of pair i holds its object where ``held[i]``."""
        missing = ~held
        asking, answering = self.pes[missing], self.owners[missing]

        def of(pes: NDArray[np.int64], costs_ps: Floats) -> Floats:
            return np.asarray(np.bincount(pes, costs_ps[missing], len(self.home_ps)), np.float64)

        computed = np.bincount(self.pes, self.compute_ps, len(self.home_ps)) + self.home_ps
        busy = computed + of(asking, self.fetching_ps) + of(answering, self.serving_ps)
        moved = of(answering, self.compute_ps + self.moving_ps) - of(asking, self.compute_ps)
        loads = (busy, busy + of(asking, self.waiting_ps), computed + moved)
        return np.array([load.max() for load in loads])

    def held_in(self, placement: Placement) -> Bools:
        """Which pairs a placement's residents hold: (P,) bool."""
        counts = np.diff(placement.replica_offsets)
        holders = np.repeat(np.arange(placement.processors), counts)
        resident = np.zeros((placement.processors, len(placement.owners)), np.bool_)
        resident[holders, placement.replica_objects] = True
        return resident[self.pes, self.objects] | (self.pes == self.owners)


def demand_of(workload: Workload, machine: Machine, placement: Placement) -> Demand:
    """Count the tests of each PE's pixels' rays by object."""
    nb, n_objects = placement.processors, workload.n_objects
    homes = placement.pixel_pes[workload.pixels].astype(np.int64)
    lengths = np.diff(workload.itinerary_offsets)
    pairs = np.repeat(homes, lengths) * n_objects + workload.itinerary_objects
    counts = np.bincount(pairs, minlength=nb * n_objects)
    kept = np.flatnonzero(counts)
    tests, (pes, objects) = counts[kept].astype(float), np.divmod(kept, n_objects)
    fetches = tests**FETCHES_EXPONENT
    n_bytes = workload.object_bytes[objects]
    request = np.full(len(kept), machine.request_bytes)
    test_ps = machine.test.of_objects(workload)[objects]
    sent = machine.send_startup_ps + machine.receive_startup_ps
    asked = _copy_ps(machine.pack[REQUEST], request) + _copy_ps(machine.unpack[OBJECT], n_bytes)
    served = _copy_ps(machine.unpack[REQUEST], request) + _copy_ps(machine.pack[OBJECT], n_bytes)
    half_ps = machine.quantum / 2 * test_ps
    return Demand(
        pes=pes,
        objects=objects,
        owners=placement.owners[objects].astype(np.int64),
        compute_ps=tests * test_ps,
        moving_ps=tests * _copy_ps(machine.unpack[RAYS], np.full(len(kept), machine.ray_bytes)),
        fetching_ps=fetches * (sent + asked),
        serving_ps=fetches * (sent + served),
        waiting_ps=fetches * (sent + served + 2 * machine.latency_ps + half_ps),
        home_ps=np.bincount(homes, minlength=nb) * float(machine.ray_ps),
    )


def _copy_ps(cost: CopyCost, n_bytes: NDArray[np.int64]) -> Floats:
    """What packing or unpacking takes, in ps: (P,) float64."""
    moved = n_bytes * (1e12 / cost.bytes_per_s) if cost.bytes_per_s else np.zeros(len(n_bytes))
    return cost.fixed_ps + moved


PAIRS = {"object": (0, 1), "concurrent": (0, 1, 2), "ray": (2,)}
"""Which fluids are held against which policy."""


def rows_of(scene: str, runs: list[dict[str, str]]) -> Iterator[dict[str, object]]:
    """A row for each fraction with a draw, policy and fluid."""
    workload, hardware = workload_for(load_scene(scene), Picture()), machine("t3e", {}, 64)
    chosen = [row for row in runs if row["kind"] == "full" and row["scene"] == scene]
    for x in sorted({Fraction(row["fraction"]) for row in chosen} - {Fraction(1, 64)}):
        here = [row for row in chosen if Fraction(row["fraction"]) == x]
        seeds = sorted({int(row["seed"]) for row in here})
        placements = [place(workload, 64, Memory(x), PlacementRules(), seed) for seed in seeds]
        demand = demand_of(workload, hardware, placements[0])
        fluid = np.log([demand.fluid_ps(demand.held_in(placement)) for placement in placements])
        for policy, numbers in PAIRS.items():
            times = {int(r["seed"]): int(r["makespan_ps"]) for r in here if r["policy"] == policy}
            simulated = np.log([times[seed] for seed in seeds])
            for number in numbers:
                r = float(np.corrcoef(fluid[:, number], simulated)[0, 1])
                off = float(np.exp((fluid[:, number] - simulated).mean()))
                row: dict[str, object] = {"scene": scene, "fraction": float(x), "policy": policy}
                row |= {"fluid": FLUIDS[number], "fluid_over_simulated": round(off, 3)}
                row |= {"spread": round(float(simulated.std(ddof=1)), 4), "r": round(r, 3)}
                yield row


def main() -> None:
    """Count, compare, write."""
    runs = all_runs()
    rows = [row for scene in FIGURE4 for row in rows_of(scene, runs)]
    path = Path(__file__).with_suffix(".csv")
    write_csv(rows, list(rows[0]), path)
    for policy, numbers in PAIRS.items():
        for name in (FLUIDS[number] for number in numbers):
            of = [row["r"] for row in rows if (row["policy"], row["fluid"]) == (policy, name)]
            print(f"{policy} by {name}: median r {np.median(np.array(of, float)):.2f}")


if __name__ == "__main__":
    main()
