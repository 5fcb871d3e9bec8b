"""Links and ports: the way of a message, and bookings against the oracle's."""

from __future__ import annotations

from dataclasses import replace
from math import prod

import numpy as np
import pytest
from by_hand import BYTE_PER_PS, MACHINE
from hypothesis import given
from hypothesis import strategies as st
from oracles.network import Network, links
from oracles.state import Message

from simmpp.machine.links import PORTS, ROWS_PER_PE, book
from simmpp.machine.torus import hops

Shape = tuple[int, int, int]
shapes = st.tuples(*[st.integers(1, 7)] * 3)


def touched(shape: Shape, source: int, destination: int) -> list[int]:
    """Rows that a message takes, in the order of its way: each hop takes 1 ps more."""
    free_ps = np.zeros(ROWS_PER_PE * prod(shape), np.int64)
    book(free_ps, shape, source, destination, 1, 1, 1, 1)
    rows = np.flatnonzero(free_ps)
    return rows[np.argsort(free_ps[rows])].tolist()


@given(shapes, st.data())
def test_the_way_is_the_oracles(shape: Shape, data: st.DataObject) -> None:
    pes = st.integers(0, prod(shape) - 1)
    source, destination = data.draw(pes), data.draw(pes)
    way = []
    for _, at, axis, sign in links(shape, source, destination):
        x, y, z = map(int, at.strip("[]").split(","))
        pe = x + shape[0] * (y + shape[1] * z)
        way.append(ROWS_PER_PE * pe + 2 * "xyz".index(axis) + "+-".index(sign))
    assert len(way) == hops(*shape, source, destination)
    ports = ROWS_PER_PE * source + PORTS, ROWS_PER_PE * destination + PORTS + 1
    assert touched(shape, source, destination) == [ports[0], *way, ports[1]]


@pytest.mark.parametrize(
    ("shape", "source", "destination", "way"),
    [
        ((2, 1, 1), 0, 1, [0]),
        ((2, 1, 1), 1, 0, [8]),  # a ring of 2 has one link from each PE, towards +
        ((4, 1, 1), 0, 2, [0, 8]),  # two hops either way: towards +
        ((4, 1, 1), 3, 1, [24, 0]),
        ((5, 1, 1), 0, 3, [1, 33]),  # back over 4
        ((3, 3, 3), 0, 26, [1, 16 + 3, 64 + 5]),  # x, y, z, each back over its border
    ],
)
def test_ways_by_hand(shape: Shape, source: int, destination: int, way: list[int]) -> None:
    assert touched(shape, source, destination)[1:-1] == way


@given(shapes, st.lists(st.tuples(*[st.integers(0, 400)] * 4), max_size=40))
def test_bookings_are_the_oracles(shape: Shape, traffic: list[tuple[int, int, int, int]]) -> None:
    machine = replace(MACHINE, shape=shape, link_bytes_per_s=BYTE_PER_PS)
    network, nb = Network(machine), prod(shape)
    free_ps = np.zeros(ROWS_PER_PE * nb, np.int64)
    for number, (depart_ps, source, destination, n_bytes) in enumerate(sorted(traffic)):
        source, destination = source % nb, destination % nb
        message = Message(0, source, destination, number, n_bytes, 0, depart_ps)
        busy_ps = n_bytes + machine.header_bytes
        arrival_ps = book(free_ps, shape, source, destination, depart_ps, 100, 30, busy_ps)
        assert arrival_ps == network.arrival(message)
