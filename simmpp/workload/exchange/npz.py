"""Rays and objects as the arrays of one npz file, which needs nothing but numpy to write."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

import numpy as np

from simmpp.common.errors import WorkloadError
from simmpp.common.files import replaced
from simmpp.workload.exchange.columns import (
    DEPOSITS,
    ITINERARY,
    MOST_ROWS,
    OBJECT_COLUMNS,
    RAY_COLUMNS,
    CheckedTable,
    Column,
    Content,
)

RAY_PREFIX, OBJECT_PREFIX, PICTURE = "ray_", "object_", "picture"
"""Beginnings of the names of arrays, and the one array that is of no table."""


def read(path: Path) -> Content:
    """Both tables; raises WorkloadError or whatever numpy and zipfile raise for a bad file."""
    where = str(path)
    file = np.load(path, allow_pickle=False)
    if not isinstance(file, np.lib.npyio.NpzFile):
        raise WorkloadError("expected an npz of several arrays, found one array", where=where)
    with file:
        arrays: dict[str, Column] = {name: file[name] for name in file.files}
    for name, array in arrays.items():
        if array.ndim != 1:
            problem = f"array {name}: it has {array.ndim} dimensions, expected 1"
            raise WorkloadError(problem, where=where)
    picture = arrays.pop(PICTURE, None)
    itineraries = {name: arrays.pop(name) for name in (*ITINERARY, DEPOSITS) if name in arrays}
    for name in arrays:
        if not name.startswith((RAY_PREFIX, OBJECT_PREFIX)):
            problem = f"array {name[:40]!r}: it is unknown{_hint(name)}"
            raise WorkloadError(problem, where=where)
    if not itineraries.keys() >= {*ITINERARY}:
        raise WorkloadError(f"expected the arrays {' and '.join(ITINERARY)}", where=where)
    n_rays = max(0, len(itineraries["itinerary_offsets"]) - 1)
    rays = _table(where, RAY_PREFIX, arrays, n_rays)
    rays.columns.update(itineraries)
    # As many as any column has: whether the one that has to be there is called so is seen later.
    lengths = {n: len(array) for n, array in arrays.items() if n.startswith(OBJECT_PREFIX)}
    n_objects = lengths.get("object_bytes", max(lengths.values(), default=0))
    objects = _table(where, OBJECT_PREFIX, arrays, n_objects)
    return Content(rays, objects, picture)


def write(tables: Content, path: Path) -> None:
    """Write both tables into one uncompressed file."""
    arrays = dict(tables.rays.columns)
    named = {name: arrays.pop(name) for name in (*ITINERARY, DEPOSITS) if name in arrays}
    for prefix, columns in ((RAY_PREFIX, arrays), (OBJECT_PREFIX, tables.objects.columns)):
        named |= {prefix + name: column for name, column in columns.items()}
    if tables.picture is not None:
        named[PICTURE] = tables.picture
    with replaced(path) as part, open(part, "wb") as file:
        np.savez(file, allow_pickle=False, **named)


def _hint(name: str) -> str:
    """What it may have been meant for."""
    known = [PICTURE, *ITINERARY, DEPOSITS, *(RAY_PREFIX + n for n in RAY_COLUMNS[1:])]
    known += [OBJECT_PREFIX + column for column in OBJECT_COLUMNS]
    near = get_close_matches(name.lower(), known, n=1)
    return f": did you mean {near[0]}?" if near else ""


def _table(where: str, prefix: str, arrays: dict[str, Column], rows: int) -> CheckedTable:
    if rows > MOST_ROWS:
        raise WorkloadError(f"{rows} rows: expected at most {MOST_ROWS}", where=where)
    columns = {
        name.removeprefix(prefix): array
        for name, array in arrays.items()
        if name.startswith(prefix)
    }
    table = CheckedTable(where, prefix, rows, columns)
    for name, column in columns.items():
        if len(column) != rows:
            table.fail(name, f"it has {len(column)} entries, expected {rows}")
    return table
