"""Ways booked at departure against links that serve whoever comes first."""

from __future__ import annotations

from dataclasses import replace
from math import prod

import numpy as np
from by_hand import MACHINE
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.hop_by_hop import HopByHop, Sent

from simmpp.machine.links import ROWS_PER_PE, book
from simmpp.machine.machine import Machine

SHAPES = ((2, 1, 1), (5, 1, 1), (4, 4, 1), (3, 3, 3), (4, 3, 2))


def booked(machine: Machine, traffic: list[Sent]) -> list[int]:
    """Arrivals by the package."""
    free_ps = np.zeros(ROWS_PER_PE * machine.processors, np.int64)
    times = (machine.latency_ps, machine.hop_latency_ps)
    return [
        book(free_ps, machine.shape, m.source, m.destination, m.depart_ps, *times, m.busy_ps)
        for m in traffic
    ]


def random_traffic(seed: int) -> tuple[Machine, list[Sent]]:
    """Up to 60 messages between random PEs, crowded or sparse."""
    rng = np.random.default_rng(seed)
    shape = SHAPES[rng.integers(len(SHAPES))]
    gap_ps, longest_ps = rng.choice((3, 100, 1000)), rng.choice((1, 30, 200))
    departs = np.cumsum(rng.integers(0, gap_ps, rng.integers(2, 60))).tolist()
    traffic = []
    for number, depart_ps in enumerate(departs):
        source, destination = rng.choice(prod(shape), 2, replace=False).tolist()
        busy_ps = int(rng.integers(longest_ps + 1))
        traffic.append(Sent(depart_ps, source, number, destination, busy_ps))
    latencies = {"latency_ps": int(rng.integers(50)), "hop_latency_ps": int(rng.integers(40))}
    return replace(MACHINE, shape=shape, **latencies), sorted(traffic)


def test_where_every_link_keeps_the_order_of_departures_arrivals_are_equal() -> None:
    in_order = 0
    for seed in range(400):
        machine, traffic = random_traffic(seed)
        first_come = HopByHop(machine, traffic)
        if first_come.keeps_order:
            in_order += 1
            found = [first_come.arrivals_ps[n] for n in range(len(traffic))]
            assert booked(machine, traffic) == found, seed
    assert 100 < in_order < 300, in_order


@given(st.integers(0, 2**32 - 1), st.sampled_from(SHAPES))
@settings(max_examples=50, deadline=None)
def test_many_to_one_ends_at_the_same_instant(seed: int, shape: tuple[int, int, int]) -> None:
    # Without hop latency, what keeps a link busy keeps the port at the end busy as well
    rng = np.random.default_rng(seed)
    machine = replace(MACHINE, shape=shape, hop_latency_ps=0)
    sources = rng.integers(1, prod(shape), 30)
    traffic = sorted(
        Sent(int(rng.integers(500)), source, n, 0, 20) for n, source in enumerate(sources.tolist())
    )
    first_come = HopByHop(machine, traffic)
    last_ps = max(first_come.arrivals_ps.values())
    assert max(booked(machine, traffic)) == last_ps


def test_overtaking_is_what_bookings_leave_out() -> None:
    # Ring of 4, both ways share link 1. PE 0's message departs first and gets there last
    #            departs  injection  link 0  link 1  (free)  ejection  arrives
    # booked  0        0          0     100     130             160       260
    #         1        1          1             101 -> 230      260       360
    # first   1        1          1             101             131       231
    #         0        0          0     100     130 -> 201      231       331
    traffic = [Sent(0, 0, 0, 2, 100), Sent(1, 1, 0, 2, 100)]
    machine = replace(MACHINE, shape=(4, 1, 1))
    assert booked(machine, traffic) == [260, 360]
    first_come = HopByHop(machine, traffic)
    assert [first_come.arrivals_ps[n] for n in range(2)] == [331, 231]
    assert not first_come.keeps_order
