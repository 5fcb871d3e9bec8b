"""Presets of today's machines against what was measured on such: met exactly, or predicted.

Single messages are met, for the constants were taken from them; rates follow from the gap. What
many messages take together is predicted, and the factor told: the constants know neither the MPI's
algorithm nor its protocols.
"""

from __future__ import annotations

import csv
import sys
from dataclasses import replace
from importlib import import_module
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from oracles.hop_by_hop import Sent
from oracles.network import network_ps
from traffic import arrivals_of_bytes

from simmpp.machine.machine import Machine
from simmpp.machine.presets import machine

EXPERIMENT = Path(__file__).parents[2] / "experiments" / "machines"


def one_way_us(made: Machine, other: int, n_bytes: int) -> float:
    """Of a message of so many bytes from PE 0, with the startups of both PEs."""
    flight_ps = network_ps(replace(made, header_bytes=0), 0, other, n_bytes)
    return (made.send_startup_ps + flight_ps + made.receive_startup_ps) / 1e6


ONE_WAY = [
    ("gpu-node", 8, 1, 0, 0.93625),  # astra-sim, HGX-H100-validated.yml
    ("gpu-cluster", 8, 4, 256, 3.75),  # cscs-reframe-tests, osu_run.py, CUDA buffers
    ("gpu-cluster", 8, 1, 0, 0.93625),
    ("cpu-cluster", 8, 1, 0, 1.2),
    ("cloud", 8, 1, 0, 76_000),  # R2E2
    ("t3e-shmem", 8, 1, 0, 0.95),  # CSC: about 1 us; one link here, two in the preset's sum
]


@pytest.mark.parametrize(("preset", "nb", "other", "n_bytes", "us"), ONE_WAY)
def test_a_small_message_takes_what_was_measured(
    preset: str, nb: int, other: int, n_bytes: int, us: float
) -> None:
    assert one_way_us(machine(preset, processors=nb), other, n_bytes) == pytest.approx(us, rel=1e-5)


BANDWIDTHS = [
    ("gpu-node", 1, 376),
    ("gpu-cluster", 4, 24),
    ("cpu-cluster", 1, 24.4),
    ("cloud", 1, 0.0157),
]


@pytest.mark.parametrize(("preset", "other", "gb_per_s"), BANDWIDTHS)
def test_large_messages_have_the_measured_bandwidth(
    preset: str, other: int, gb_per_s: float
) -> None:
    made = machine(preset, processors=8)
    more_us = one_way_us(made, other, 2 << 20) - one_way_us(made, other, 1 << 20)
    assert (1 << 20) / more_us / 1e3 == pytest.approx(gb_per_s, rel=1e-4)


def test_messages_follow_each_other_at_the_measured_rate() -> None:
    made = machine("gpu-cluster", processors=8)
    found = arrivals_of_bytes(made, [Sent(0, 0, n, 4, 256) for n in range(100)])
    rate_mb_per_s = 256 / (np.diff(found).mean() / 1e6)
    assert rate_mb_per_s == pytest.approx(200, rel=1e-3)  # cscs-reframe-tests, osu_run.py


def test_the_table_of_published_measurements_is_what_the_networks_make() -> None:
    """All but what many PEs do together; what a constant was taken from has a factor of 1."""
    sys.path.append(str(EXPERIMENT))
    published = import_module("published")
    with open(EXPERIMENT / "published.csv", newline="") as file:
        lines = {line["what"]: line for line in csv.DictReader(file)}
    for row in (*published.single_messages(), *published.rates()):
        line = lines[row.what]
        assert line["preset"] == row.preset and float(line["measured"]) == row.measured
        assert float(line["simulated"]) == pytest.approx(row.simulated, rel=1e-3)
        if row.kind == published.TAKEN:
            closely = 0.06 if row.preset == "t3e-shmem" else 2e-3  # that is "about 1 us"
            assert row.simulated / row.measured == pytest.approx(1, rel=closely), row.what


MEASURED_US = {8: 148.55, 65536: 395.63, 1 << 20: 6751.7}
"""Of an all-to-all of 64 ranks on 16 nodes, GPU buffers: pmodels/mpich, issue 7375."""
FACTORS = {8: 0.58, 65536: 0.44, 1 << 20: 0.42}
"""Predicted / measured. MPICH's pairwise exchange waits for both at each step, and for sizes of no
less than 64 KiB each message has a handshake before it."""


@pytest.mark.parametrize("n_bytes", MEASURED_US)
def test_an_all_to_all_is_predicted_within_a_factor(n_bytes: int) -> None:
    made, nb = machine("gpu-cluster", processors=64), 64
    steps = product(range(1, nb), range(nb))
    traffic = [Sent(0, pe, step, (pe + step) % nb, n_bytes) for step, pe in steps]
    last_us = int(arrivals_of_bytes(made, sorted(traffic)).max()) / 1e6
    startups_us = (made.send_startup_ps + made.receive_startup_ps) / 1e6
    assert (last_us + startups_us) / MEASURED_US[n_bytes] == pytest.approx(
        FACTORS[n_bytes], rel=0.05
    )
