"""Is it enough that a message books all links of its way when it departs?

    python experiments/contention/contention.py

That would take one event a message; the engines take one for each link, so that each link serves
whoever comes first. Real runs with contention (512 x 512, depth 5, 64 PEs, x = 0.1, seed 0) are
made both ways, and the messages of the exact run are replayed with their departures three times: by
the engine's links, by a SimPy process for each message that asks for each link (which must give the
same arrivals to the picosecond), and booked. Writes contention.csv, a row per scene, bandwidth of
links and policy. *late* is a booked arrival less the exact one; times of messages are in us, of
runs in ms, costs in us of CPU for each message.
"""

from __future__ import annotations

import csv
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from simpy.events import Event

from simmpp.common.compiled import njit
from simmpp.engine.initial import new_state
from simmpp.engine.simpy_engine import SimpyRun
from simmpp.engine.state import State
from simmpp.machine.machine import UNLIMITED, Machine
from simmpp.machine.presets import machine
from simmpp.machine.torus import (
    LINKS,
    ROWS_PER_PE,
    hops,
    link_towards,
    port,
)
from simmpp.machine.transfer import PS_PER_S, slower, transfer_ps
from simmpp.placement.place import place
from simmpp.placement.placement import Memory, PlacementRules
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.cache.store import workload_for
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.hop_by_hop import HopByHop, Sent
from traffic import arrivals_ps

HERE = Path(__file__).parent
SCENES = ("mountain:5", "tetra:5")
BANDWIDTHS = ("480 MB/s", "48 MB/s", "4.8 MB/s")
"""Of links: the T3E's, and slower ones. At the first, ports are the bottleneck (340 MB/s)."""
POLICIES = ("object", "ray", "concurrent")
PROCESSORS = 64
US, MS = 10**6, 10**9

Row = dict[str, str | int | float]
Times = NDArray[np.int64]


@njit
def book(
    free_ps: Times,
    shape: tuple[int, int, int],
    ends: tuple[int, int],
    depart_ps: int,
    latencies_ps: tuple[int, int],
    busy_ps: int,
) -> int:
    """Reserve every link and port of a way at once; returns the arrival."""
    here, destination = ends
    latency_ps, hop_latency_ps = latencies_ps
    head_ps = _reserve(free_ps, port(here, 0), depart_ps, busy_ps) + latency_ps
    while here != destination:
        link, here = link_towards(shape, here, destination)
        head_ps = _reserve(free_ps, link, head_ps, busy_ps) + hop_latency_ps
    return _reserve(free_ps, port(here, 1), head_ps, busy_ps) + busy_ps


@njit
def _reserve(free_ps: Times, row: int, head_ps: int, busy_ps: int) -> int:
    start_ps = max(head_ps, free_ps[row])
    free_ps[row] = start_ps + busy_ps
    return start_ps


@njit
def book_all(shape: tuple[int, int, int], traffic: Times, latencies_ps: tuple[int, int]) -> Times:
    """Arrivals of messages (departure, source, destination, time on a link)."""
    free_ps = np.zeros(ROWS_PER_PE * shape[0] * shape[1] * shape[2], np.int64)
    found = np.zeros(len(traffic), np.int64)
    for n, (depart_ps, source, destination, busy_ps) in enumerate(traffic):
        ends = (source, destination)
        found[n] = book(free_ps, shape, ends, depart_ps, latencies_ps, busy_ps)
    return found


class Recorded(SimpyRun):
    """A run that notes what departs."""

    def __init__(self, state: State) -> None:
        super().__init__(state)
        self.traffic: list[Sent] = []

    def _carry(self, n_sent: int) -> None:
        for row in self.state.arrays["outbox"][:n_sent].tolist():
            self.traffic.append(sent(self.state, row))
        super()._carry(n_sent)


class Booked(SimpyRun):
    """A run whose messages book their whole way, in the order of departure, source and number."""

    def __init__(self, state: State, chosen: Machine) -> None:
        super().__init__(state)
        self._free_ps = np.zeros(ROWS_PER_PE * PROCESSORS, np.int64)
        self._shape = chosen.shape
        self._latencies_ps = (chosen.latency_ps, chosen.hop_latency_ps)

    def _carry(self, n_sent: int) -> None:
        for row in self.state.arrays["outbox"][:n_sent].tolist():
            departing = Event(self._environment)
            departing._ok, departing._value = True, row
            departing.callbacks.append(self._depart)
            m = sent(self.state, row)
            priority = (2 << 64 | m.source) << 64 | m.number
            self._environment.schedule(departing, priority, m.depart_ps - self._environment.now)

    def _depart(self, departing: Event) -> None:
        row = departing.value
        m = sent(self.state, row)
        ends = (m.source, m.destination)
        arrival_ps = book(
            self._free_ps, self._shape, ends, m.depart_ps, self._latencies_ps, m.n_bytes
        )
        self.state.messages["arrival_ps"][row] = arrival_ps
        self._let_arrive(row)


def sent(state: State, row: int) -> Sent:
    """A message that has been packed; its bytes are told as of a link of one per ps."""
    m = state.messages[row]
    rate = slower(state["link_bytes_per_s"], state["injection_bytes_per_s"])
    busy_ps = transfer_ps(int(m["payload_bytes"]) + state["header_bytes"], rate)
    ends = (int(m["source"]), int(m["number"]), int(m["destination"]))
    return Sent(int(m["depart_ps"]), *ends, busy_ps)


def new_run(scene: str, chosen: Machine, policy: str) -> State:
    """A run at time 0."""
    workload = workload_for(load_scene(scene), Picture())
    placement = place(workload, PROCESSORS, Memory(), PlacementRules(), seed=0)
    parameters = PolicyParameters(policy)
    return new_state(
        workload,
        chosen,
        placement,
        parameters,
        ready_order="depth-first",
    )


def timed(work: Callable[[], Times]) -> tuple[Times, float]:
    """What it gives, and the CPU seconds that it took."""
    began_s = time.process_time()
    found = work()
    return found, time.process_time() - began_s


def by_processes(chosen: Machine, traffic: list[Sent]) -> Times:
    """Arrivals where each message is a process."""
    a_byte_a_ps = replace(chosen, link_bytes_per_s=PS_PER_S, injection_bytes_per_s=UNLIMITED)
    found = HopByHop(a_byte_a_ps, traffic).arrivals_ps
    return np.array([found[n] for n in range(len(traffic))])


def alone_ps(chosen: Machine, traffic: list[Sent]) -> Times:
    """How long each message would take on an empty network."""
    ways = [hops(*chosen.shape, m.source, m.destination) for m in traffic]
    busy_ps = np.array([m.n_bytes for m in traffic])
    return chosen.latency_ps + chosen.hop_latency_ps * np.array(ways) + busy_ps


def row_of(scene: str, bandwidth: str, policy: str) -> Row:
    """Both networks in one run each, and on the same messages."""
    chosen = machine("t3e", {"contention": LINKS, "link_bandwidth": bandwidth}, PROCESSORS)
    run, booking = Recorded(new_run(scene, chosen, policy)), new_run(scene, chosen, policy)
    run.run()
    Booked(booking, chosen).run()
    traffic = sorted(run.traffic)
    table = np.array([(m.depart_ps, m.source, m.destination, m.n_bytes) for m in traffic])
    latencies_ps = (chosen.latency_ps, chosen.hop_latency_ps)
    book_all(chosen.shape, table[:1], latencies_ps)  # compile
    exact = arrivals_ps(chosen, traffic)
    slow, slow_s = timed(lambda: by_processes(chosen, traffic))
    if (exact != slow).any():
        raise SystemExit(f"{scene} {bandwidth} {policy}: the engine's links and SimPy's differ")
    booked, booked_s = timed(lambda: book_all(chosen.shape, table, latencies_ps))
    flights, late, n = alone_ps(chosen, traffic), booked - exact, len(traffic)
    makespan_ps = run.state["last_ray_ps"]
    return {
        "scene": scene,
        "link_bandwidth": bandwidth,
        "policy": policy,
        "messages": n,
        "mean_flight_alone_us": flights.mean() / US,
        "mean_wait_us": (exact - table[:, 0] - flights).mean() / US,
        "mean_wait_booked_us": (booked - table[:, 0] - flights).mean() / US,
        "share_equal": (late == 0).mean(),
        "mean_abs_late_us": np.abs(late).mean() / US,
        "p99_abs_late_us": np.quantile(np.abs(late), 0.99) / US,
        "earliest_us": late.min() / US,
        "latest_us": late.max() / US,
        "last_arrival_ms": exact.max() / MS,
        "last_arrival_booked_ms": booked.max() / MS,
        "makespan_ms": makespan_ps / MS,
        "makespan_booked_ms": booking["last_ray_ps"] / MS,
        "cost_processes_us": slow_s / n * 1e6,
        "cost_booked_us": booked_s / n * 1e6,
    }


def main() -> None:
    """Measure every case; write rows as they come."""
    cases = [(s, b, p) for s in SCENES for b in BANDWIDTHS for p in POLICIES]
    with open(HERE / "contention.csv", "w", encoding="utf-8", newline="") as file:
        for number, case in enumerate(cases):
            row = row_of(*case)
            row = {k: v if isinstance(v, str | int) else f"{v:.5g}" for k, v in row.items()}
            writer = csv.DictWriter(file, list(row), lineterminator="\n")
            if number == 0:
                writer.writeheader()
            writer.writerow(row)
            file.flush()
            print(row, flush=True)


if __name__ == "__main__":
    main()
