"""Workloads from other renderers, and for other tools: rays x objects in Parquet or npz.

A workload is two tables, of rays and of objects. README.md beside this file has their columns, with
type, meaning and default.
"""

from __future__ import annotations

import hashlib
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import WorkloadError
from simmpp.common.files import in_utf8, refuse_special
from simmpp.common.units import LONGEST_PS
from simmpp.common.validate import require_kind
from simmpp.workload.check import check
from simmpp.workload.exchange import npz
from simmpp.workload.exchange.columns import (
    DEPOSITS,
    MOST_ROWS,
    OBJECT_COLUMNS,
    WORKLOAD_SUFFIXES,
    CheckedTable,
    Column,
    Content,
    is_workload,
)
from simmpp.workload.exchange.rays import rays_of
from simmpp.workload.exchange.roots import root_columns
from simmpp.workload.workload import MESH, OBJECT_KINDS, RAY_KINDS, Workload, frozen

MOST_OBJECT_BYTES = 2**40
"""A TiB for one object; the sum of all stays far from the end of int64."""
UNREADABLE = (
    *(OSError, ValueError, TypeError, KeyError, EOFError, MemoryError, OverflowError),
    *(NotImplementedError, RuntimeError, zipfile.BadZipFile),
)
"""What numpy, zipfile and (by their bases) pyarrow raise for a file that is not what it seems."""


def import_workload(path: str | os.PathLike[str]) -> Workload:
    """The workload in the tables at ``path``; its name is the file's.

    Raises WorkloadError, one line that names file, column, row, value and what was expected.
    """
    require_kind("path", path, str, os.PathLike)
    path = Path(path)
    tables = _read(path)
    arrays = rays_of(tables.rays, tables.objects.rows) | _objects_of(tables.objects)
    picture, samples = _picture(tables, int((arrays["parents"] < 0).sum()))
    # Of what was read, not of the file: the same rays in Parquet and in npz are one workload.
    digest = hashlib.sha256(repr((*picture, samples) if samples > 1 else picture).encode())
    for name in sorted(arrays):
        digest.update(f"{name} {arrays[name].shape}".encode())
        digest.update(np.ascontiguousarray(arrays[name]).data)
    name = in_utf8(path.stem)
    workload = frozen(Workload(name, digest.hexdigest(), picture, **arrays, samples=samples))
    check(workload, str(path))
    return workload


def export_workload(workload: Workload, path: str | os.PathLike[str]) -> None:
    """Write a workload as tables; in Parquet the objects go into the file beside the rays.

    Raises WorkloadError if the name ends in neither .parquet nor .npz, OSError if it can't be
    written.
    """
    require_kind("workload", workload, Workload)
    require_kind("path", path, str, os.PathLike)
    path = Path(path)
    finite = np.isfinite(workload.hit_distances)
    rays: dict[str, Column] = {
        "itinerary_offsets": workload.itinerary_offsets,
        "itinerary_objects": workload.itinerary_objects,
        "parent": workload.parents,
        "kind": np.array(RAY_KINDS)[workload.kinds],
        "pixel": workload.pixels,
        "hit": workload.hits,
        "distance": np.where(finite, workload.hit_distances, 0.0),
        **root_columns(workload),
    }
    if len(workload.ray_test_scales):
        rays["test_scale"] = workload.ray_test_scales
    if len(workload.test_deposits):
        rays[DEPOSITS] = workload.test_deposits / 2.0**32
    objects: dict[str, Column] = {
        "bytes": workload.object_bytes,
        "kind": np.array(OBJECT_KINDS)[workload.object_kinds],
        "triangles": workload.object_triangles,
        **({"test_ps": workload.object_test_ps} if len(workload.object_test_ps) else {}),
        **({"results": workload.object_results} if len(workload.object_results) else {}),
        **dict(zip("xyz", workload.object_centroids.T, strict=True)),
    }
    sides = (*workload.picture, workload.samples) if workload.samples > 1 else workload.picture
    tables = Content(
        CheckedTable(str(path), "", workload.n_rays, rays),
        CheckedTable(str(path), "", workload.n_objects, objects),
        np.array(sides),
    )
    _format(path).write(tables, path)


def _format(path: Path) -> Any:
    """The module that reads and writes such files."""
    if not is_workload(path.name):
        raise WorkloadError(f"expected a file {' or '.join(WORKLOAD_SUFFIXES)}", where=str(path))
    if path.suffix.lower() == ".npz":
        return npz
    from simmpp.workload.exchange import parquet  # pyarrow takes a third of a second

    return parquet


def _read(path: Path) -> Content:
    tables = _format(path)
    if not path.exists():
        raise WorkloadError("there is no such file", where=str(path))
    try:
        refuse_special(path)
        read: Content = tables.read(path)
    except UNREADABLE as error:
        reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
        line = " ".join(reason.split())[:200]
        raise WorkloadError(f"can't be read: {line}", where=str(path)) from None
    return read


def _objects_of(table: CheckedTable) -> dict[str, NDArray[Any]]:
    """The fields of a workload that hold objects."""
    table.known(OBJECT_COLUMNS, required=("bytes",))
    mesh = np.full(table.rows, MESH, np.uint8)
    sizes = table.integers("bytes", 0, MOST_OBJECT_BYTES, 0, "a size from 0 to 2^40 bytes")
    costs = table.integers("test_ps", 0, LONGEST_PS, 0, "a time from 0 to 10 s in picoseconds")
    results = table.integers("results", 0, MOST_OBJECT_BYTES, 0, "a size from 0 to 2^40 bytes")
    for name, column in (("bytes", sizes), ("results", results)):
        if column.sum(dtype=np.float64) > MOST_OBJECT_BYTES * 2.0**20:
            table.fail(name, "the sum is beyond 2^60")
    return {
        "object_kinds": table.choices("kind", OBJECT_KINDS, mesh),
        "object_triangles": table.integers("triangles", 0, MOST_ROWS, 0).astype(np.int32),
        "object_bytes": sizes,
        "object_centroids": np.stack([table.numbers(axis) for axis in "xyz"], axis=1),
        "object_test_ps": costs if "test_ps" in table.columns else costs[:0],
        **({"object_results": results} if results.any() else {}),
    }


def _picture(tables: Content, n_primaries: int) -> tuple[tuple[int, int], int]:
    """Rows and columns, and primary rays of each pixel; a list of rays is one ray wide."""
    if tables.picture is None:
        return (n_primaries, 1), 1
    sides = tables.picture
    whole = sides.dtype.kind in "iu" and len(sides) in (2, 3) and (sides > 0).all()
    rows, columns, samples = (*map(int, sides), 1)[:3] if whole else (0, 0, 0)
    if rows * columns * samples != n_primaries:
        text = " ".join(map(str, sides.tolist()))[:40]
        expected = f"expected rows and columns of the {n_primaries} primary rays"
        raise WorkloadError(f"picture: value {text}: {expected}", where=tables.rays.where)
    return (rows, columns), samples
