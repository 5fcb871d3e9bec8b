"""Rays of another renderer, checked and numbered as a workload wants them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.exchange.columns import (
    DEPOSIT_OFFSETS,
    DEPOSITS,
    ITINERARY,
    RAY_COLUMNS,
    CheckedTable,
)
from simmpp.workload.exchange.numbering import by_generation, first_repeat, regrouped, row_in_cycle
from simmpp.workload.exchange.roots import roots_of
from simmpp.workload.workload import (
    BARREN,
    MOST_TEST_SCALE,
    PARTICLE,
    PRIMARY,
    RAY_KINDS,
    REFLECTED,
    ROOTS,
)

Ints = NDArray[np.int64]
MOST_DEPOSIT = 2**20
"""So that float64 tells one unit from the next."""


def rays_of(table: CheckedTable, n_objects: int) -> dict[str, NDArray[Any]]:
    """The fields of a workload that hold rays; raises WorkloadError for what makes no sense."""
    table.known((*RAY_COLUMNS, *ITINERARY, DEPOSITS, DEPOSIT_OFFSETS), required=ITINERARY)
    n = table.rows
    parents = table.integers("parent", -1, n - 1, -1, f"-1 or a row from 0 to {n - 1}")
    kinds = table.choices("kind", RAY_KINDS, np.where(parents < 0, PRIMARY, REFLECTED))
    _check_kinds(table, parents, kinds)
    offsets, objects = _itineraries(table, n_objects, kinds)
    deposits = _deposits(table, offsets)
    scales = table.integers("test_scale", 0, MOST_TEST_SCALE, 0).astype(np.uint8)
    n_children = np.bincount(parents[parents >= 0], minlength=n)
    hits = _hits(table, offsets, objects, n_children, n_objects)
    distances = np.where(hits < 0, np.inf, _distances(table, hits))
    order, roots = _numbered(table, parents, kinds)
    number = np.empty(n, np.int64)
    number[order] = np.arange(n)
    new_offsets, entries = regrouped(offsets, order)
    # Children lie in the order of their parents: where they begin is a sum over those before.
    first_children = int((parents < 0).sum()) + np.cumsum(n_children[order])
    return {
        "kinds": kinds[order],
        "parents": np.where(parents < 0, -1, number[parents])[order].astype(np.int32),
        "child_offsets": np.append(first_children - n_children[order], n).astype(np.int32),
        "pixels": number[roots].astype(np.int32),
        "hits": hits[order].astype(np.int32),
        "hit_distances": distances[order],
        "itinerary_offsets": new_offsets,
        "itinerary_objects": objects[entries].astype(np.int32),
        **({"ray_test_scales": scales[order]} if scales.any() else {}),
        **({"test_deposits": deposits[entries]} if len(deposits) else {}),
        **roots_of(table, parents, order, roots, n_objects),
    }


def _check_kinds(table: CheckedTable, parents: Ints, kinds: NDArray[np.uint8]) -> None:
    if (parents >= 0).all():
        table.fail("parent", "there is no primary ray: expected -1 in at least one row")
    wrong = np.flatnonzero((np.isin(kinds, ROOTS) != (parents < 0)) & (kinds != PARTICLE))
    if len(wrong):
        row = int(wrong[0])
        has = f"has parent {parents[row]}" if parents[row] >= 0 else "has no parent"
        table.fail("kind", f"a {RAY_KINDS[kinds[row]]} ray {has}", row)
    for barren in BARREN:
        fertile = (parents < 0) | (kinds[parents] != barren)
        table.require(fertile, "parent", f"no {RAY_KINDS[barren]} ray, which spawns nothing")


def _itineraries(
    table: CheckedTable, n_objects: int, kinds: NDArray[np.uint8]
) -> tuple[Ints, Ints]:
    """Offsets and objects, once they are found to fit the rays and the objects."""
    offsets, objects = (table.columns[name] for name in ITINERARY)
    for column in (offsets, objects):
        if column.dtype.kind not in "iu":
            table.fail("itinerary", f"it holds {column.dtype}, expected integers")
    offsets = offsets.astype(np.int64)
    if offsets[0] != 0 or offsets[-1] != len(objects) or (np.diff(offsets) < 0).any():
        table.fail("itinerary", f"offsets don't rise from 0 to the {len(objects)} objects' number")
    outside = (objects < 0) | (objects >= n_objects)
    if outside.any():
        entry = int(np.argmax(outside))
        row = int(np.searchsorted(offsets, entry, side="right")) - 1
        expected = f"a row of the {n_objects} objects" if n_objects else "nothing: no objects"
        table.fail("itinerary", f"value {objects[entry]}: expected {expected}", row)
    objects = objects.astype(np.int64)
    row, twice = first_repeat(offsets, objects, n_objects, kinds)
    if row >= 0:
        table.fail("itinerary", f"object {twice} occurs twice: expected each once", row)
    return offsets, objects


def _deposits(table: CheckedTable, offsets: Ints) -> Ints:
    """What each entry of the itineraries deposits, in units of 2^-32; (0,) where it is not told."""
    if DEPOSITS not in table.columns:
        return np.zeros(0, np.int64)
    numbers = table.columns[DEPOSITS]
    own = table.columns.get(DEPOSIT_OFFSETS, offsets)
    if len(numbers) != offsets[-1] or (own != offsets).any():
        row = int(np.argmax(np.append(own[1:] != offsets[1:], True))) % max(table.rows, 1)
        table.fail("deposit", "expected a number for each object of the itinerary", row)
    if numbers.dtype.kind not in "iuf":
        table.fail("deposit", f"it holds {numbers.dtype}, expected numbers")
    wrong = ~((numbers >= 0) & (numbers <= MOST_DEPOSIT))
    if wrong.any():
        entry = int(np.argmax(wrong))
        row = int(np.searchsorted(offsets, entry, side="right")) - 1
        expected = f"a number from 0 to {MOST_DEPOSIT}"
        table.fail("deposit", f"value {numbers[entry]}: expected {expected}", row)
    return np.rint(numbers.astype(np.float64) * 2.0**32).astype(np.int64)


def _hits(
    table: CheckedTable, offsets: Ints, objects: Ints, n_children: Ints, n_objects: int
) -> Ints:
    """The object hit by each ray, -1 for none: (n,) int64."""
    spawners, empty = n_children > 0, np.diff(offsets) == 0
    wrong = spawners & empty
    if wrong.any():
        row = int(np.argmax(wrong))
        table.fail("itinerary", "it is empty: a ray that spawns others has hit an object", row)
    if "hit" not in table.columns:
        # What spawned others was hit, and an itinerary ends there; of the rest nothing is known.
        hits = np.full(table.rows, -1, np.int64)
        hits[spawners] = objects[offsets[1:][spawners] - 1]
        return hits
    hits = table.integers("hit", -1, n_objects - 1, -1, f"-1 or a row of the {n_objects} objects")
    rows = np.repeat(np.arange(table.rows), np.diff(offsets))
    tested = hits < 0
    tested[rows[objects == hits[rows]]] = True
    table.require(tested, "hit", "an object of the itinerary")
    table.require(~spawners | (hits >= 0), "hit", "an object: the ray spawns others")
    return hits


def _distances(table: CheckedTable, hits: Ints) -> NDArray[np.float64]:
    distances = table.numbers("distance", where=hits >= 0)
    table.require((distances >= 0) | (hits < 0), "distance", "a distance of at least 0")
    return distances


def _numbered(table: CheckedTable, parents: Ints, kinds: NDArray[np.uint8]) -> tuple[Ints, Ints]:
    """Rows in their new order, and the row of each one's primary ray."""
    pixels = table.integers("pixel", -1, 2**62, -1, "a place in the picture, or -1")
    if "pixel" in table.columns:
        table.require((pixels >= 0) | (parents >= 0), "pixel", "a primary ray's place from 0")
    order, roots = by_generation(parents, kinds, pixels)
    if len(order) < table.rows:
        row = row_in_cycle(parents, order)
        table.fail("parent", f"value {parents[row]}: the ray is its own ancestor", row)
    wrong = np.flatnonzero((pixels[order] != pixels[roots]) & (pixels[order] >= 0))
    if len(wrong):
        row = int(order[wrong].min())
        table.fail("pixel", f"value {pixels[row]}: its primary ray has another", row)
    return order, roots
