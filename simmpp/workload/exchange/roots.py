"""What a table of rays may say of roots, rays without a parent: their round, home and weight."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.check import first_gap
from simmpp.workload.exchange.columns import MOST_ROWS, CheckedTable, Column
from simmpp.workload.workload import Workload

Ints = NDArray[np.int64]


def roots_of(
    table: CheckedTable, parents: Ints, order: Ints, roots: Ints, n_objects: int
) -> dict[str, NDArray[Any]]:
    """The fields of a workload that hold roots, of those columns that say anything.

    ``order`` are the rows as they are numbered, roots first, ``roots`` the row of each one's root.
    """
    first = order[parents[order] < 0]
    rounds = table.integers("round", -1, MOST_ROWS, 0, "a round from 0")
    of_object = f"-1 or a row of the {n_objects} objects"
    homes = table.integers("home", -1, n_objects - 1, -1, of_object)
    weights = table.numbers("weight", where=parents < 0)
    if "round" in table.columns:
        table.require((rounds >= 0) | (parents >= 0), "round", "a round from 0")
        _refuse_gap(table, rounds, first)
    for name, values in (("round", rounds), ("home", homes)):
        wrong = np.flatnonzero((values[order] != values[roots]) & (values[order] >= 0))
        if name in table.columns and len(wrong):
            row = int(order[wrong].min())
            table.fail(name, f"value {values[row]}: its root has another", row)
    table.require((weights >= 0) | (parents >= 0), "weight", "a weight from 0")
    said: dict[str, NDArray[Any]] = {
        "root_rounds": rounds[first].astype(np.int32),
        "root_homes": homes[first].astype(np.int32),
        "root_weights": weights[first] if "weight" in table.columns else np.ones(1),
    }
    nothing = {"root_rounds": 0, "root_homes": -1, "root_weights": 1}
    return {name: array for name, array in said.items() if np.any(array != nothing[name])}


def _refuse_gap(table: CheckedTable, rounds: Ints, first: Ints) -> None:
    """A round that no root is of would be waited for by all, and end with nobody."""
    gap = first_gap(rounds[first])
    if gap >= 0:
        behind = first[rounds[first] > gap].min()
        problem = f"value {rounds[behind]}: no root is of round {gap}"
        table.fail("round", problem, int(behind))


def root_columns(workload: Workload) -> dict[str, Column]:
    """The same as columns of all rays: what is said of a root is said of its descendants."""
    arrays: dict[str, Column] = {
        "round": workload.root_rounds,
        "home": workload.root_homes,
        "weight": workload.root_weights,
    }
    return {name: array[workload.pixels] for name, array in arrays.items() if len(array)}
