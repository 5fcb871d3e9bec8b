"""What tests cost, by the triangles of what they are made against."""

from __future__ import annotations

import numpy as np
import pytest
from builders import workload_of
from hypothesis import given
from hypothesis import strategies as st
from oracles.costs import intersection_ps

from simmpp.common.errors import ConfigError
from simmpp.machine.constants import Constants
from simmpp.machine.machine import TestCost, depths
from simmpp.machine.presets import OVERRIDDEN, layered, load_preset, machine
from simmpp.workload.workload import MESH

TREE = {"test": {"mesh": "10 ns", "log2": "12 ns"}}


def test_a_tree_of_n_triangles_has_log2_levels() -> None:
    triangles = np.array([0, 1, 2, 3, 4, 5, 1000, 1024, 1025, 2**31 - 1], np.int32)
    assert depths(triangles).tolist() == [0, 0, 1, 2, 2, 3, 10, 10, 11, 31]


@given(triangles=st.lists(st.integers(0, 2**31 - 1), min_size=1, max_size=9))
def test_parts_with_a_tree_cost_what_the_oracle_says(triangles: list[int]) -> None:
    n = len(triangles)
    workload = workload_of(
        0, [], object_bytes=[1] * n, object_kinds=[MESH] * n, object_triangles=triangles
    )
    made = machine("t3e", TREE)
    expected = [intersection_ps(made, workload, obj) for obj in range(n)]
    assert made.test.of_objects(workload).tolist() == expected


def test_log2_replaces_what_a_triangle_costs_and_the_other_way_round() -> None:
    per_triangle = Constants.model_validate({"test": {"per_triangle": "3 ns"}})
    log2 = Constants.model_validate(TREE)
    layers = layered("t3e", per_triangle)
    layers.put(log2, lambda key: "the second")
    assert (layers.numbers["test.per_triangle"], layers.numbers["test.log2"]) == (0, 12_000)
    assert layers.sources["test.per_triangle"] == "the second"
    layers.put(per_triangle, lambda key: "the third")
    assert (layers.numbers["test.per_triangle"], layers.numbers["test.log2"]) == (3000, 0)
    assert machine("t3e", TREE).test == TestCost(*[4_000_000] * 3, 10_000, log2_ps=12_000)
    assert machine("t3e", TREE).sources["test.log2"] == OVERRIDDEN
    assert load_preset("t3e").constants.flat()["test.log2"] == 0


def test_both_are_refused_in_one_line() -> None:
    with pytest.raises(ConfigError, match=r"^test.log2: it replaces test.per_triangle: expected"):
        machine("t3e", {"test": {"log2": "1 ns", "per_triangle": "1 ns"}})
