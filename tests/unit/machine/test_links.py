"""The way of a message over links, against the oracle's."""

from __future__ import annotations

from math import prod

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.network import links

from simmpp.machine.torus import ROWS_PER_PE, hops, link_towards

Shape = tuple[int, int, int]
shapes = st.tuples(*[st.integers(1, 7)] * 3)


def rows_of_way(shape: Shape, source: int, destination: int) -> list[int]:
    """Rows of the links that a message takes, one after the other."""
    rows, here = [], source
    while here != destination:
        row, here = link_towards(shape, here, destination)
        rows.append(int(row))
    return rows


@given(shapes, st.data())
def test_the_way_is_the_oracles(shape: Shape, data: st.DataObject) -> None:
    pes = st.integers(0, prod(shape) - 1)
    source, destination = data.draw(pes), data.draw(pes)
    way = []
    for _, at, axis, sign in links(shape, source, destination):
        x, y, z = map(int, at.strip("[]").split(","))
        pe = x + shape[0] * (y + shape[1] * z)
        way.append(ROWS_PER_PE * pe + 2 * "xyz".index(axis) + "+-".index(sign))
    assert rows_of_way(shape, source, destination) == way
    assert len(way) == hops(*shape, source, destination)


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
    assert rows_of_way(shape, source, destination) == way
