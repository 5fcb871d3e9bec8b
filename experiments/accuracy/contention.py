"""How far are ways booked at departure from links that serve whoever comes first?

    PYTHONPATH=tests python experiments/accuracy/contention.py

The messages of real runs with contention (512 x 512, depth 5, 64 PEs, x = 0.1, seed 0) are replayed
with their departures through ``simmpp.machine.links`` and through a SimPy process for each message,
which asks for each link when its head gets there (``tests/oracles/hop_by_hop.py``). Writes
contention.csv, a row per scene, bandwidth of links and policy. Times of messages are in us, *late*
is an arrival that was booked less the one of the processes.
"""

from __future__ import annotations

import csv
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from oracles.hop_by_hop import HopByHop, Sent

from simmpp.compiled import njit
from simmpp.engine.simpy_engine import SimpyRun
from simmpp.engine.state import State, new_state
from simmpp.machine.links import LINKS, ROWS_PER_PE, book
from simmpp.machine.machine import Machine
from simmpp.machine.network import transfer_ps
from simmpp.machine.presets import machine
from simmpp.machine.torus import hops
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.scene.load import load_scene
from simmpp.workload.picture import Picture
from simmpp.workload.store import workload_for

HERE = Path(__file__).parent
SCENES = ("mountain:5", "tetra:5")
BANDWIDTHS = ("480 MB/s", "48 MB/s", "4.8 MB/s")
"""Of links: the T3E's, and slower ones. At the first, ports are the bottleneck (340 MB/s)."""
POLICIES = ("object", "ray", "concurrent")
PROCESSORS = 64
US = 10**6

Row = dict[str, str | int | float]
Times = NDArray[np.int64]


class Recorded(SimpyRun):
    """A run that notes what departs."""

    def __init__(self, state: State) -> None:
        super().__init__(state)
        self.traffic: list[Sent] = []

    def _let_depart(self, row: int) -> None:
        super()._let_depart(row)
        m, state = self.state.messages[row], self.state
        n_bytes = int(m["payload_bytes"]) + state["header_bytes"]
        ends = (int(m["source"]), int(m["number"]), int(m["destination"]))
        busy_ps = transfer_ps(n_bytes, state["bytes_per_s"])
        self.traffic.append(Sent(int(m["depart_ps"]), *ends, busy_ps))


def traffic_of(scene: str, chosen: Machine, policy: str) -> list[Sent]:
    """All messages of one run, in the order of their departures."""
    workload = workload_for(load_scene(scene), Picture())
    placement = place(workload, PROCESSORS, Memory(), PlacementRules(), seed=0)
    parameters = PolicyParameters(policy)
    state = new_state(
        workload,
        chosen,
        placement,
        parameters,
        ready_order="depth-first",
        record_tests=False,
    )
    run = Recorded(state)
    run.run()
    return sorted(run.traffic)


@njit
def _book_all(
    free_ps: Times,
    shape: tuple[int, int, int],
    traffic: Times,
    latency_ps: int,
    hop_latency_ps: int,
) -> Times:
    arrivals_ps = np.zeros(len(traffic), np.int64)
    for n, (depart_ps, source, destination, busy_ps) in enumerate(traffic):
        arrivals_ps[n] = book(
            free_ps, shape, source, destination, depart_ps, latency_ps, hop_latency_ps, busy_ps
        )
    return arrivals_ps


def booked(chosen: Machine, traffic: list[Sent]) -> tuple[Times, float]:
    """Arrivals, and CPU seconds."""
    rows = np.array([(m.depart_ps, m.source, m.destination, m.busy_ps) for m in traffic], np.int64)
    free_ps = np.zeros(ROWS_PER_PE * PROCESSORS, np.int64)
    times = (chosen.latency_ps, chosen.hop_latency_ps)
    _book_all(free_ps.copy(), chosen.shape, rows[:1], *times)  # compile first
    began_s = time.process_time()
    found = _book_all(free_ps, chosen.shape, rows, *times)
    return found, time.process_time() - began_s


def served(chosen: Machine, traffic: list[Sent]) -> tuple[Times, float]:
    """Arrivals where links serve whoever comes first, and CPU seconds."""
    began_s = time.process_time()
    found = HopByHop(chosen, traffic).arrivals_ps
    seconds = time.process_time() - began_s
    return np.array([found[n] for n in range(len(traffic))]), seconds


def alone(chosen: Machine, traffic: list[Sent]) -> Times:
    """Arrivals on empty links."""
    flights_ps = [
        chosen.latency_ps
        + hops(*chosen.shape, m.source, m.destination) * chosen.hop_latency_ps
        + m.busy_ps
        for m in traffic
    ]
    return np.array([m.depart_ps for m in traffic]) + np.array(flights_ps)


def row_of(scene: str, bandwidth: str, policy: str) -> Row:
    """Both networks on the messages of one run."""
    chosen = machine("t3e", {"contention": LINKS, "link_bandwidth": bandwidth}, PROCESSORS)
    traffic = traffic_of(scene, chosen, policy)
    (ours, ours_s), (theirs, theirs_s) = booked(chosen, traffic), served(chosen, traffic)
    free, late = alone(chosen, traffic), ours - theirs
    n = len(traffic)
    return {
        "scene": scene,
        "link_bandwidth": bandwidth,
        "policy": policy,
        "messages": n,
        "mean_flight_us": float(np.mean(free - [m.depart_ps for m in traffic])) / US,
        "mean_wait_served_us": float(np.mean(theirs - free)) / US,
        "mean_wait_booked_us": float(np.mean(ours - free)) / US,
        "equal": float(np.mean(late == 0)),
        "mean_abs_late_us": float(np.mean(np.abs(late))) / US,
        "p99_abs_late_us": float(np.quantile(np.abs(late), 0.99)) / US,
        "earliest_us": int(late.min()) / US,
        "latest_us": int(late.max()) / US,
        "last_arrival_ms": int(theirs.max()) / (1000 * US),
        "last_arrival_late_us": int(ours.max() - theirs.max()) / US,
        "booked_us_per_message": ours_s / n * 1e6,
        "served_us_per_message": theirs_s / n * 1e6,
    }


def main() -> None:
    """Measure every case; write rows as they come."""
    with open(HERE / "contention.csv", "w", encoding="utf-8", newline="") as file:
        writer: csv.DictWriter[str] | None = None
        for scene in SCENES:
            for bandwidth in BANDWIDTHS:
                for policy in POLICIES:
                    row = row_of(scene, bandwidth, policy)
                    row = {k: f"{v:.6g}" if isinstance(v, float) else v for k, v in row.items()}
                    writer = writer or csv.DictWriter(file, list(row), lineterminator="\n")
                    if file.tell() == 0:
                        writer.writeheader()
                    writer.writerow(row)
                    print(row, flush=True)


if __name__ == "__main__":
    main()
