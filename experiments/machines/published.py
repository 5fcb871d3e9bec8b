"""What was measured on real networks, and what the presets' constants make of it.

    python experiments/machines/published.py

Messages go through the package's own links and ports, with contention; startups of both PEs are
added to what one of them takes. Nothing is packed, as benchmarks send what lies in one piece.
Writes published.csv: *taken* is what a constant of the preset comes from, so its factor is 1 by
construction (that is tested), *predicted* what follows from the constants.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

from simmpp.common.files import write_csv
from simmpp.machine.machine import Machine
from simmpp.machine.presets import machine

sys.path.append(str(Path(__file__).parents[2] / "tests"))

from oracles.hop_by_hop import Sent
from traffic import arrivals_of_bytes

HERE = Path(__file__).parent
TAKEN, PREDICTED = "taken", "predicted"
MIB = 1 << 20
MANY = 100
"""Messages in a row."""
ONE_CARD = {"system": {"ports": 1}}
HOST = {"network": {"latency": "1.435333 us", "bandwidth": "24 GB/s", "gap": "427 ns"}}
"""Slingshot 11 between buffers of the host: 256 B in 2.3 us, and at 600 MB/s back to back."""
CSCS = "eth-cscs/cscs-reframe-tests, osu_run.py"
MPICH = "pmodels/mpich, issue 7375"
CHAPEL = "chapel-lang/chapel, pull request 23013"


class Measured(NamedTuple):
    """A line of the table."""

    what: str
    preset: str
    kind: str
    measured: float
    simulated: float
    unit: str
    source: str


def one_way_us(of: Machine, other: int, n_bytes: int = 0) -> float:
    """A single message from PE 0, with the startups of both PEs."""
    flight_ps = int(arrivals_of_bytes(of, [Sent(0, 0, 0, other, n_bytes)])[0])
    return (of.send_startup_ps + flight_ps + of.receive_startup_ps) / 1e6


def gb_per_s(of: Machine, pairs: list[tuple[int, int]], n_bytes: int) -> float:
    """Of all pairs together, which send back to back: of what arrives after the first."""
    traffic = [Sent(0, a, n, b, n_bytes) for n in range(MANY) for a, b in pairs]
    found = np.sort(arrivals_of_bytes(of, sorted(traffic)))
    return len(pairs) * (MANY - 1) * n_bytes / (int(found[-1] - found[0]) / 1e12) / 1e9


def all_to_all_us(of: Machine, n_bytes: int) -> float:
    """Until the last message of every PE to every other has arrived; PE + 1 is sent to first."""
    nb = of.processors
    steps = product(range(1, nb), range(nb))
    traffic = [Sent(0, pe, step, (pe + step) % nb, n_bytes) for step, pe in steps]
    last_us = int(arrivals_of_bytes(of, sorted(traffic)).max()) / 1e6
    return last_us + (of.send_startup_ps + of.receive_startup_ps) / 1e6


def aggregated_gb_per_s(of: Machine, n_bytes: int) -> float:
    """What each node sends, in buffers of so many bytes to all others in turn."""
    nb = of.processors
    traffic = [
        Sent(0, pe, n, (pe + 1 + n % (nb - 1)) % nb, n_bytes)
        for n in range(MANY)
        for pe in range(nb)
    ]
    last_ps = int(arrivals_of_bytes(of, sorted(traffic)).max())
    return MANY * n_bytes / (last_ps / 1e12) / 1e9


def of(preset: str, nb: int = 8, **overrides: object) -> Machine:
    """A preset's machine."""
    return machine(preset, overrides, processors=nb)


def single_messages() -> Iterator[Measured]:
    """Ping-pongs: half a round trip."""
    host = of("gpu-cluster", levels=HOST)
    nvlink = "astra-sim/astra-sim, HGX-H100-validated.yml"
    rows = [
        ("small, NVLink", of("gpu-node"), 1, 0, 0.93625, TAKEN, nvlink),
        ("256 B, GPUs of two nodes", of("gpu-cluster"), 4, 256, 3.75, TAKEN, CSCS),
        ("4 MiB, GPUs of two nodes", of("gpu-cluster"), 4, 4 * MIB, 180.0, PREDICTED, CSCS),
        ("256 B, hosts", host, 4, 256, 2.3, TAKEN, CSCS),
        ("4 MiB, hosts", host, 4, 4 * MIB, 180.0, PREDICTED, CSCS),
        ("small, RoCE bond", of("cpu-cluster"), 1, 0, 5.8, PREDICTED, "openucx/ucx, issue 6242"),
        ("a bag of rays", of("cloud"), 1, 0, 76_000.0, TAKEN, "R2E2, run a, Little's law"),
        ("small, SHMEM", of("t3e-shmem"), 1, 0, 1.0, TAKEN, "CSC, Cray T3E User's Guide, p. 62"),
        ("small, MPI", of("t3e"), 1, 0, 30.0, PREDICTED, "CSC, Cray T3E User's Guide, p. 62"),
    ]
    for what, made, other, n_bytes, us, kind, source in rows:
        found = one_way_us(made, other, n_bytes)
        yield Measured(f"one way, {what}", made.name, kind, us, found, "us", source)


def rates() -> Iterator[Measured]:
    """Messages back to back."""
    host, cluster = of("gpu-cluster", levels=HOST), of("gpu-cluster")
    one, across = [(0, 1)], [(0, 4)]
    pairs = [(rank, rank + 8) for rank in range(8)]
    rail = of("cpu-cluster", link_bandwidth="12.2 GB/s")
    lmcache = "LMCache, pull request 4161"
    rows = [
        ("NVLink", of("gpu-node"), one, 4 * MIB, 376, TAKEN, "NVIDIA/nccl, issue 1264"),
        ("one card", cluster, across, 4 * MIB, 24, TAKEN, CSCS),
        ("256 B, one pair of GPUs", cluster, across, 256, 0.2, TAKEN, CSCS),
        ("256 B, one pair of hosts", host, across, 256, 0.6, TAKEN, CSCS),
        (
            "8 pairs on 4 nodes",
            of("gpu-cluster", 16),
            pairs,
            4 * MIB,
            48.251,
            PREDICTED,
            "eth-cscs/cscs-reframe-tests, pull request 624",
        ),
        (
            "8 pairs on 4 nodes, had each one card",
            of("gpu-cluster", 16, levels=ONE_CARD),
            pairs,
            4 * MIB,
            48.251,
            PREDICTED,
            "the same",
        ),
        ("two rails of 100 Gb/s", of("cpu-cluster"), one, 64 * MIB, 24.4, TAKEN, lmcache),
        ("one rail", rail, one, 64 * MIB, 12.2, TAKEN, lmcache),
        ("SHMEM", of("t3e-shmem"), one, 4 * MIB, 0.34, TAKEN, "Ames Laboratory, MP_Lite"),
    ]
    for what, made, between, n_bytes, measured, kind, source in rows:
        found = gb_per_s(made, between, n_bytes)
        yield Measured(f"bandwidth, {what}", made.name, kind, measured, found, "GB/s", source)


def all_to_all() -> Iterator[Measured]:
    """64 ranks on 16 nodes, GPU buffers."""
    made = of("gpu-cluster", 64)
    for n_bytes, us in {8: 148.55, 4096: 132.9, 65536: 395.63, MIB: 6751.7}.items():
        what = f"all-to-all of 64, {n_bytes} B each"
        found = all_to_all_us(made, n_bytes)
        yield Measured(what, made.name, PREDICTED, us, found, "us", MPICH)


def aggregation() -> Iterator[Measured]:
    """Small messages put together into buffers, by their size; 64 nodes stand for 256."""
    made = of("gpu-cluster", 64, levels=HOST)
    for n_bytes, measured in {512: 6.69, 1024: 9.68, 2048: 9.86, 4096: 9.77, 8192: 9.14}.items():
        what = f"a node's buffers of {n_bytes} B, Slingshot 11"
        found = aggregated_gb_per_s(made, n_bytes)
        yield Measured(what, made.name, PREDICTED, measured, found, "GB/s", CHAPEL)
    made = of("cpu-cluster", 16)
    found = aggregated_gb_per_s(made, 8192)
    source = "chapel-lang/chapel, pull request 18326"
    yield Measured(
        "a node's buffers of 8192 B, HDR", made.name, PREDICTED, 2.65, found, "GB/s", source
    )
    gain = found / aggregated_gb_per_s(made, 8)
    source = "chapel-lang/chapel, issue 16963"
    yield Measured(
        "gain of 8192 B over 8 B, InfiniBand", made.name, PREDICTED, 1000, gain, "times", source
    )


def main() -> None:
    """Simulate, write the table, print it."""
    rows = []
    for parts in (single_messages(), rates(), all_to_all(), aggregation()):
        for measured in parts:
            row = measured._asdict() | {
                "simulated": float(f"{measured.simulated:.4g}"),
                "factor": f"{measured.simulated / measured.measured:.2f}",
            }
            print(" | ".join(map(str, row.values())), flush=True)
            rows.append(row)
    write_csv(rows, list(rows[0]), HERE / "published.csv")


if __name__ == "__main__":
    main()
