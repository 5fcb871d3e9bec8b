"""Patterns of traffic whose times have closed forms; all messages take T on each link and port."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import prod

import numpy as np
import pytest
from by_hand import MACHINE
from oracles.hop_by_hop import HopByHop, Sent

from simmpp.machine.links import ROWS_PER_PE, book
from simmpp.machine.torus import hops

Shape = tuple[int, int, int]
SHAPES: tuple[Shape, ...] = ((2, 2, 2), (4, 4, 4), (8, 4, 2), (3, 5, 1))
T_PS, LATENCY_PS, HOP_PS = 1000, 100, 30


def booked(shape: Shape, pairs: Iterable[tuple[int, int]], hop_ps: int = HOP_PS) -> list[int]:
    """Arrivals of messages (source, destination) that all depart at 0, in this order."""
    free_ps = np.zeros(ROWS_PER_PE * prod(shape), np.int64)
    return [book(free_ps, shape, a, b, 0, LATENCY_PS, hop_ps, T_PS) for a, b in pairs]


def served(shape: Shape, pairs: list[tuple[int, int]]) -> list[int]:
    """The same where links and ports serve whoever comes first."""
    machine = replace(MACHINE, shape=shape, latency_ps=LATENCY_PS, hop_latency_ps=HOP_PS)
    traffic = [Sent(0, a, n, b, T_PS) for n, (a, b) in enumerate(pairs)]
    found = HopByHop(machine, traffic).arrivals_ps
    return [found[n] for n in range(len(pairs))]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("axis", range(3))
def test_all_send_to_their_next_neighbour_and_none_waits(shape: Shape, axis: int) -> None:
    if shape[axis] == 1:
        return
    pes = np.arange(prod(shape)).reshape(shape[::-1])
    next_ones = np.roll(pes, -1, axis=2 - axis)
    pairs = list(zip(pes.ravel().tolist(), next_ones.ravel().tolist(), strict=True))
    alone = [LATENCY_PS + HOP_PS + T_PS] * len(pairs)
    assert booked(shape, pairs) == served(shape, pairs) == alone


@pytest.mark.parametrize("shape", SHAPES)
def test_one_to_all_leave_the_port_one_by_one(shape: Shape) -> None:
    pairs = [(0, to) for to in range(1, prod(shape))]
    expected = [
        n * T_PS + LATENCY_PS + hops(*shape, 0, to) * HOP_PS + T_PS
        for n, (_, to) in enumerate(pairs)
    ]
    assert booked(shape, pairs) == served(shape, pairs) == expected


@pytest.mark.parametrize("shape", SHAPES)
def test_all_to_one_come_in_one_by_one(shape: Shape) -> None:
    # The port at the end is never idle from the first head on: n messages take n T
    n = prod(shape) - 1
    arrivals = sorted(booked(shape, [(pe, 0) for pe in range(1, n + 1)], hop_ps=0))
    assert arrivals == [LATENCY_PS + k * T_PS for k in range(1, n + 1)]


@pytest.mark.parametrize("size", [2, 3, 4, 7, 8, 15])
def test_all_to_all_on_a_ring_loads_its_links_and_takes_at_least_that(size: int) -> None:
    # A link towards + carries 1 + 2 + ... + n / 2 messages, one towards - up to (n - 1) / 2
    pairs = [(pe, (pe + d) % size) for d in range(1, size) for pe in range(size)]
    carried = np.zeros((size, ROWS_PER_PE), np.int64)
    for pe, to in pairs:
        free_ps = np.zeros(ROWS_PER_PE * size, np.int64)
        book(free_ps, (size, 1, 1), pe, to, 0, 0, 0, 1)
        carried += free_ps.reshape(size, ROWS_PER_PE) > 0
    forward, back = (half * (half + 1) // 2 for half in (size // 2, (size - 1) // 2))
    assert carried.tolist() == [[forward, back, 0, 0, 0, 0, size - 1, size - 1]] * size
    least_ps = LATENCY_PS + max(forward, size - 1) * T_PS
    first_come, in_order = max(served((size, 1, 1), pairs)), max(booked((size, 1, 1), pairs))
    assert least_ps <= first_come <= in_order


@pytest.mark.parametrize("size", [5, 8, 16, 64])
def test_a_shift_by_two_at_one_instant_is_what_bookings_are_worst_at(size: int) -> None:
    # Served, every message finds its first link free and waits T less a hop for its second. Booked,
    # each waits for its first link until the one before, which was booked for two links at once,
    # has passed it: a chain all round the ring
    pairs = [(pe, (pe + 2) % size) for pe in range(size)]
    assert served((size, 1, 1), pairs) == [LATENCY_PS + HOP_PS + 2 * T_PS] * size
    chain_ps = (size - 1) * (HOP_PS + T_PS)
    assert max(booked((size, 1, 1), pairs)) == chain_ps + LATENCY_PS + 2 * HOP_PS + T_PS
