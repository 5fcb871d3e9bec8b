"""Sparse state: hashed tables of records and doubly linked lists, in plain arrays.

Of the nb x N pairs (PE, object) and the nb x nb pairs (PE, PE) only those that something is known
about have a row, so memory grows with what happens, not with the size of the machine. The arrays
are reserved at an upper bound, but the system gives memory only to pages that were touched. What
is empty is all zeros, so nothing has to be written before: hence "plus 1" below.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import NONE, Row

FREE, USED = 0, 1


class Table(NamedTuple):
    """Rows found by a 64-bit key; a hash table with chains."""

    buckets: NDArray[np.int32]
    """(2^k,) int32: first row of each bucket, plus 1; 0 for none."""
    rows: NDArray[np.void]
    """(capacity,) records with at least the fields ``key`` (int64) and ``chain`` (int32)."""
    marks: NDArray[np.int32]
    """(2,) int32: head of the list of freed rows, plus 1, 0 for none; number of rows ever used."""


class Lists(NamedTuple):
    """Doubly linked lists; an item is in at most one list of the family."""

    ends: NDArray[np.int32]
    """(2 * lists,) int32: first and last item of each, plus 1; 0 when empty."""
    links: NDArray[np.int32]
    """(2 * items,) int32: previous and next item of each."""


@kernel
def _bucket(table: Table, key: int) -> np.int64:
    # Fibonacci hashing: the upper bits of key * 2^64 / golden ratio.
    mixed = np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)
    return np.int64((mixed >> np.uint64(33)) & np.uint64(table.buckets.size - 1))


@kernel
def find(table: Table, key: int) -> int:
    """The row of ``key``, or NONE."""
    row = table.buckets[_bucket(table, key)] - 1
    while row >= 0 and table.rows[row].key != key:
        row = table.rows[row].chain
    return row


@kernel
def add(table: Table, key: int) -> int:
    """A new row for ``key``, which must not have one; its other fields are the caller's to set."""
    row = take(table.rows, table.marks)
    bucket = _bucket(table, key)
    table.rows[row].key = key
    table.rows[row].chain = table.buckets[bucket] - 1
    table.buckets[bucket] = row + 1
    return row


@kernel
def remove(table: Table, row: int) -> None:
    """Forget a row; its place is used again."""
    bucket = _bucket(table, table.rows[row].key)
    before = table.buckets[bucket] - 1
    if before == row:
        table.buckets[bucket] = table.rows[row].chain + 1
    else:
        while table.rows[before].chain != row:
            before = table.rows[before].chain
        table.rows[before].chain = table.rows[row].chain
    give_back(table.rows, table.marks, row)


@kernel
def take(rows: NDArray[np.void], marks: NDArray[np.int32]) -> int:
    """A free place among ``rows``; freed places are linked through ``chain``."""
    row = marks[FREE] - 1
    if row >= 0:
        marks[FREE] = rows[row].chain + 1
        return row
    row = marks[USED]
    if row >= rows.size:
        raise MemoryError("a table of the simulated machine is full")
    marks[USED] = row + 1
    return row


@kernel
def give_back(rows: NDArray[np.void], marks: NDArray[np.int32], row: int) -> None:
    """Make a place free again."""
    rows[row].chain = marks[FREE] - 1
    marks[FREE] = row + 1


@kernel
def link(rows: NDArray[np.void], ends: Row, row: int) -> None:
    """Put a row at the end of a simple list: ``ends`` has its first and last, rows their next."""
    rows[row].next = NONE
    if ends.first == NONE:
        ends.first = row
    else:
        rows[ends.last].next = row
    ends.last = row


@kernel
def first(lists: Lists, which: int) -> int:
    """The first item of list ``which``, or NONE."""
    return lists.ends[2 * which] - 1


@kernel
def following(lists: Lists, item: int) -> int:
    """The item after ``item`` in its list, or NONE."""
    return lists.links[2 * item + 1]


@kernel
def append(lists: Lists, which: int, item: int) -> None:
    """Put ``item`` at the end of list ``which``."""
    last = lists.ends[2 * which + 1] - 1
    lists.links[2 * item] = last
    lists.links[2 * item + 1] = NONE
    if last >= 0:
        lists.links[2 * last + 1] = item
    else:
        lists.ends[2 * which] = item + 1
    lists.ends[2 * which + 1] = item + 1


@kernel
def unlink(lists: Lists, which: int, item: int) -> None:
    """Take ``item`` out of list ``which``, wherever it stands."""
    before, after = lists.links[2 * item], lists.links[2 * item + 1]
    if before >= 0:
        lists.links[2 * before + 1] = after
    else:
        lists.ends[2 * which] = after + 1
    if after >= 0:
        lists.links[2 * after] = before
    else:
        lists.ends[2 * which + 1] = before + 1


@kernel
def clear(lists: Lists, which: int) -> None:
    """Empty list ``which``; its items are in no list then."""
    lists.ends[2 * which] = 0
    lists.ends[2 * which + 1] = 0


@kernel
def sort_by_key(keys: NDArray[np.int64], items: NDArray[np.int64], n: int) -> None:
    """Sort the first n items by their distinct keys, in place (Shell sort, Ciura's gaps)."""
    # Keys are distinct, so it does not matter that Shell sort is not stable.
    for gap in (1750, 701, 301, 132, 57, 23, 10, 4, 1):
        for i in range(gap, n):
            key, item = keys[i], items[i]
            j = i
            while j >= gap and keys[j - gap] > key:
                keys[j], items[j] = keys[j - gap], items[j - gap]
                j -= gap
            keys[j], items[j] = key, item
