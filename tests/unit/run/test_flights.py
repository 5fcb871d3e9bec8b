"""Means over pairs of PEs, against all pairs one by one on the package's networks."""

from __future__ import annotations

from dataclasses import asdict
from itertools import permutations
from statistics import fmean
from typing import Any

import pytest
from oracles.network import network_ps

from simmpp.machine.presets import machine
from simmpp.run.flights import Flight, mean_flight, shares_of_pairs

LEVELS = {
    "node": {"size": 4, "latency": "1 us", "bandwidth": "100 GB/s", "send_startup": "2 us"},
    "group": {"size": 3, "latency": "3 us"},
    "system": {"latency": "7 us", "bandwidth": "5 GB/s"},
}
MACHINES: list[tuple[str, dict[str, Any], int]] = [
    ("t3e", {"shape": [4, 3, 1]}, 12),
    ("t3e", {}, 2),
    ("bluegene-l", {"shape": [5, 1, 1]}, 5),
    ("cpu-cluster", {"fat_tree": {"arity": 2}}, 7),
    ("cpu-cluster", {"fat_tree": {"arity": 4, "levels": 3}}, 18),
    ("cpu-cluster", {"levels": LEVELS}, 27),
    ("gpu-cluster", {}, 10),
    ("gpu-node", {}, 8),
]


@pytest.mark.parametrize(("preset", "overrides", "nb"), MACHINES)
def test_the_mean_is_that_of_all_pairs(preset: str, overrides: dict[str, Any], nb: int) -> None:
    made = machine(preset, overrides | {"header_bytes": "0 B"}, nb)
    pairs, a_mb = list(permutations(range(nb), 2)), 10**6
    latency_ps = fmean(network_ps(made, *pair, 0) for pair in pairs)
    with_bytes_ps = fmean(network_ps(made, *pair, a_mb) for pair in pairs)
    flight = mean_flight(asdict(made))
    assert flight.latency_ps == pytest.approx(latency_ps, abs=1)
    assert a_mb / flight.bytes_per_s * 1e12 == pytest.approx(with_bytes_ps - latency_ps, rel=1e-6)


def test_startups_of_levels_count_as_often_as_messages_stay_within() -> None:
    made = machine("cpu-cluster", {"levels": LEVELS, "send_startup": 0, "receive_startup": 0}, 12)
    within = 3 / 11  # of the 11 others 3 are in the node
    flight = mean_flight(asdict(made))
    assert (flight.send_startup_ps, flight.receive_startup_ps) == (round(2e6 * within), 0)


def test_one_pe_sends_nothing() -> None:
    for preset in ("t3e", "cpu-cluster", "gpu-node"):
        made = machine(preset, {}, 1)
        assert isinstance(mean_flight(asdict(made)), Flight)
    assert shares_of_pairs(1, [1, 1]) == [0, 1]
