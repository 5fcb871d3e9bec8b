"""Hops against a breadth-first search over the links of the torus, and default shapes."""

from __future__ import annotations

from collections import deque
from itertools import product
from math import prod

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.machine.torus import default_shape, hops

Shape = tuple[int, int, int]
shapes = st.tuples(*[st.integers(1, 7)] * 3)


def searched_hops(shape: Shape, source: int) -> list[int]:
    """Distance of every PE from ``source``, link by link."""
    x_size, y_size, _ = shape
    distance = [-1] * prod(shape)
    distance[source] = 0
    queue = deque([source])
    while queue:
        pe = queue.popleft()
        x, y, z = pe % x_size, pe // x_size % y_size, pe // (x_size * y_size)
        for step, axis in product((1, -1), range(3)):
            to = [x, y, z]
            to[axis] = (to[axis] + step) % shape[axis]
            neighbour = to[0] + x_size * (to[1] + y_size * to[2])
            if distance[neighbour] < 0:
                distance[neighbour] = distance[pe] + 1
                queue.append(neighbour)
    return distance


@given(shapes, st.data())
def test_hops_are_the_shortest_way_over_links(shape: Shape, data: st.DataObject) -> None:
    source = data.draw(st.integers(0, prod(shape) - 1))
    assert [hops(*shape, source, pe) for pe in range(prod(shape))] == searched_hops(shape, source)


@pytest.mark.parametrize(
    ("processors", "shape"),
    [
        (1, (1, 1, 1)),
        (2, (2, 1, 1)),
        (8, (2, 2, 2)),
        (12, (3, 2, 2)),
        (13, (13, 1, 1)),
        (32, (4, 4, 2)),
        (64, (4, 4, 4)),
        (128, (8, 4, 4)),
        (512, (8, 8, 8)),
        (2048, (16, 16, 8)),
        (16384, (32, 32, 16)),
    ],
)
def test_default_shapes_are_near_cubic(processors: int, shape: Shape) -> None:
    assert default_shape(processors) == shape


@given(st.integers(1, 3000))
def test_no_shape_has_a_smaller_sum(processors: int) -> None:
    chosen = default_shape(processors)
    assert prod(chosen) == processors
    assert chosen[0] >= chosen[1] >= chosen[2]
    divisors = [d for d in range(1, processors + 1) if processors % d == 0]
    sums = (
        a + b + processors // (a * b)
        for a in divisors
        for b in divisors
        if processors % (a * b) == 0
    )
    assert sum(chosen) == min(sums)
