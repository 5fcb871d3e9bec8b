"""Tables against a dictionary, lists against Python's, sorting against ``sorted``."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.engine.arrays import hashtable
from simmpp.engine.arrays.records import MISS, NONE


def from_python(kernel: Any) -> Any:
    """A function that Python can call."""

    @numba.njit
    def call(*arguments: Any) -> Any:
        return kernel(*arguments)

    return call


NAMES = ("find", "add", "remove", "first", "following", "append", "unlink", "sort_by_key")
tables = SimpleNamespace(**{name: from_python(getattr(hashtable, name)) for name in NAMES})
CAPACITY = 12
keys = st.integers(0, 2**40) | st.integers(0, 20)


def new_table() -> hashtable.Table:
    return hashtable.Table(np.zeros(16, np.int32), np.zeros(CAPACITY, MISS), np.zeros(2, np.int32))


@given(st.lists(st.tuples(st.booleans(), keys)))
def test_a_table_is_a_dictionary(operations: list[tuple[bool, int]]) -> None:
    table, known = new_table(), dict[int, int]()
    for adds, key in operations:
        if adds and key not in known and len(known) < CAPACITY:
            known[key] = tables.add(table, key)
        elif not adds and key in known:
            tables.remove(table, known.pop(key))
        assert tables.find(table, key) == known.get(key, NONE)
    assert {key: tables.find(table, key) for key in known} == known
    assert len(set(known.values())) == len(known)


def test_a_full_table_says_so() -> None:
    table = new_table()
    for key in range(CAPACITY):
        tables.add(table, key)
    with pytest.raises(MemoryError, match="full"):
        tables.add(table, CAPACITY)


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 7))))
def test_linked_lists_keep_their_order(operations: list[tuple[int, int]]) -> None:
    lists = hashtable.Lists(np.zeros(6, np.int32), np.zeros(16, np.int32))
    expected: list[list[int]] = [[], [], []]
    for which, item in operations:
        holder = next((k for k in range(3) if item in expected[k]), None)
        if holder is None:
            tables.append(lists, which, item)
            expected[which].append(item)
        else:
            tables.unlink(lists, holder, item)
            expected[holder].remove(item)
    for which in range(3):
        found, item = [], tables.first(lists, which)
        while item != NONE:
            found.append(item)
            item = tables.following(lists, item)
        assert found == expected[which]


@given(st.lists(st.integers(0, 10**12), unique=True, max_size=400))
def test_sorting(numbers: list[int]) -> None:
    sort_keys = np.array([*numbers, 7], np.int64)
    items = np.arange(len(numbers) + 1)
    tables.sort_by_key(sort_keys, items, len(numbers))
    assert sort_keys.tolist() == [*sorted(numbers), 7]
    assert items.tolist()[:-1] == sorted(range(len(numbers)), key=numbers.__getitem__)
