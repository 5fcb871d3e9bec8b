"""Patterns of traffic whose times have closed forms; all messages take T on each link and port."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from math import prod

import numpy as np
import pytest
from by_hand import MACHINE
from oracles.hop_by_hop import Sent
from traffic import arrivals_ps

from simmpp.machine.torus import ROWS_PER_PE, hops, link_towards

Shape = tuple[int, int, int]
SHAPES: tuple[Shape, ...] = ((2, 2, 2), (4, 4, 4), (8, 4, 2), (3, 5, 1))
T_PS, LATENCY_PS, HOP_PS = 1000, 100, 30


def ours(shape: Shape, pairs: list[tuple[int, int]], hop_ps: int = HOP_PS) -> list[int]:
    """Arrivals of messages (source, destination) that all depart at 0."""
    machine = replace(MACHINE, shape=shape, latency_ps=LATENCY_PS, hop_latency_ps=hop_ps)
    traffic = [Sent(0, a, n, b, T_PS) for n, (a, b) in enumerate(pairs)]
    return arrivals_ps(machine, traffic).tolist()


def rows_of_way(shape: Shape, here: int, destination: int) -> list[int]:
    """Rows of the links between two PEs."""
    rows = []
    while here != destination:
        row, here = link_towards(shape, here, destination)
        rows.append(row)
    return rows


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("axis", range(3))
def test_all_send_to_their_next_neighbour_and_none_waits(shape: Shape, axis: int) -> None:
    if shape[axis] == 1:
        return
    pes = np.arange(prod(shape)).reshape(shape[::-1])
    next_ones = np.roll(pes, -1, axis=2 - axis)
    pairs = list(zip(pes.ravel().tolist(), next_ones.ravel().tolist(), strict=True))
    alone = [LATENCY_PS + HOP_PS + T_PS] * len(pairs)
    assert ours(shape, pairs) == alone


@pytest.mark.parametrize("shape", SHAPES)
def test_one_to_all_leave_the_port_one_by_one(shape: Shape) -> None:
    pairs = [(0, to) for to in range(1, prod(shape))]
    expected = [
        n * T_PS + LATENCY_PS + hops(*shape, 0, to) * HOP_PS + T_PS
        for n, (_, to) in enumerate(pairs)
    ]
    assert ours(shape, pairs) == expected


@pytest.mark.parametrize("shape", SHAPES)
def test_all_to_one_come_in_one_by_one(shape: Shape) -> None:
    # The port at the end is never idle from the first head on: n messages take n T
    n = prod(shape) - 1
    arrivals = sorted(ours(shape, [(pe, 0) for pe in range(1, n + 1)], hop_ps=0))
    assert arrivals == [LATENCY_PS + k * T_PS for k in range(1, n + 1)]


@pytest.mark.parametrize("size", [2, 3, 4, 7, 8, 15])
def test_all_to_all_on_a_ring_loads_its_links_and_takes_at_least_that(size: int) -> None:
    # A link towards + carries 1 + 2 + ... + n / 2 messages, one towards - up to (n - 1) / 2
    pairs = [(pe, (pe + d) % size) for d in range(1, size) for pe in range(size)]
    carried = Counter(row for pair in pairs for row in rows_of_way((size, 1, 1), *pair))
    forward, back = (half * (half + 1) // 2 for half in (size // 2, (size - 1) // 2))
    assert {carried[ROWS_PER_PE * pe] for pe in range(size)} == {forward}
    assert {carried[ROWS_PER_PE * pe + 1] for pe in range(size)} == {back}
    assert sum(carried.values()) == size * (forward + back)
    least_ps = LATENCY_PS + max(forward, size - 1) * T_PS
    assert least_ps <= max(ours((size, 1, 1), pairs)) <= 2 * least_ps


@pytest.mark.parametrize("size", [5, 8, 16, 64])
def test_a_shift_by_two_waits_once(size: int) -> None:
    # Every message finds its first link free and waits T less a hop for its second
    pairs = [(pe, (pe + 2) % size) for pe in range(size)]
    assert ours((size, 1, 1), pairs) == [LATENCY_PS + HOP_PS + 2 * T_PS] * size
