"""Links and ports against a SimPy process for each message that asks for one after the other."""

from __future__ import annotations

from dataclasses import replace
from math import prod

import numpy as np
import pytest
from builders import on_some_network, random_case
from by_hand import MACHINE
from oracles.hop_by_hop import HopByHop, Sent
from oracles.machine import Simulation
from traffic import arrivals_ps

from simmpp.machine.machine import Machine
from simmpp.machine.torus import LINKS
from simmpp.policy.parameters import POLICIES

SHAPES = ((2, 1, 1), (5, 1, 1), (4, 4, 1), (3, 3, 3), (4, 3, 2))


def random_traffic(seed: int) -> tuple[Machine, list[Sent]]:
    """Up to 60 messages between random PEs, crowded or sparse, with many ties."""
    rng = np.random.default_rng(seed)
    shape = SHAPES[rng.integers(len(SHAPES))]
    gap_ps, longest_ps = rng.choice((1, 3, 100, 1000)), rng.choice((0, 1, 30, 200))
    departs = np.cumsum(rng.integers(0, gap_ps + 1, rng.integers(2, 60))).tolist()
    traffic = []
    for number, depart_ps in enumerate(departs):
        source, destination = rng.choice(prod(shape), 2, replace=False).tolist()
        n_bytes = int(rng.integers(longest_ps + 1))  # a byte a picosecond
        traffic.append(Sent(depart_ps, source, number, destination, n_bytes))
    latencies = {"latency_ps": int(rng.integers(50)), "hop_latency_ps": int(rng.integers(40))}
    if rng.random() < 0.2:
        latencies = {"latency_ps": 0, "hop_latency_ps": 0}
    machine = replace(MACHINE, shape=shape, **latencies)
    return on_some_network(machine, seed), sorted(traffic)


@pytest.mark.parametrize("first_seed", range(0, 400, 100))
def test_arrivals_of_any_traffic_are_equal(first_seed: int) -> None:
    for seed in range(first_seed, first_seed + 100):
        machine, traffic = random_traffic(seed)
        expected = HopByHop(machine, traffic).arrivals_ps
        found = arrivals_ps(machine, traffic).tolist()
        assert found == [expected[n] for n in range(len(traffic))], seed


def test_arrivals_of_whole_runs_are_equal() -> None:
    # The oracle's runs, whose every integer is the engines': their departures once more
    for seed in range(60):
        case = random_case(seed)
        machine = replace(case.machine, contention=LINKS)
        rules = POLICIES[case.policy.name]
        parts = (case.workload, machine, case.placement, case.policy, case.ready_order, rules)
        simulation = Simulation(*parts)
        simulation.run()
        ledger = simulation.ledger
        sent = sorted(
            Sent(
                m.departure,
                m.source,
                m.send_number,
                m.destination,
                m.payload_bytes + machine.header_bytes,
            )
            for m in ledger.sent
        )
        arrivals = HopByHop(machine, sent).arrivals_ps
        expected = {(m.source, m.number): arrivals[n] for n, m in enumerate(sent)}
        for time, _, source, number, *_ in ledger.arrivals:
            assert time == expected[source, number], seed


def test_who_comes_first_is_served_first() -> None:
    # Ring of 4, both ways share link 1. PE 0's message departs first and gets there last
    # from  departs  injection  link 0  link 1        ejection  arrives
    # 1     1        1                  101           131       231
    # 0     0        0          100     130 -> 201    231       331
    traffic = [Sent(0, 0, 0, 2, 100), Sent(1, 1, 0, 2, 100)]
    machine = replace(MACHINE, shape=(4, 1, 1))
    assert arrivals_ps(machine, traffic).tolist() == [331, 231]
