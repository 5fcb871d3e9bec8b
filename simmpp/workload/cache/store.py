"""Workloads on disk: one Arrow file each, checked when read, kept in the user's cache.

The arrays of a workload that is read are the file's own pages, so processes of a sweep share one
copy in memory. The file is a table of one row: each array is a list in a cell, aligned as Arrow
aligns it; the rest stands as JSON in the schema's metadata.
"""

from __future__ import annotations

import dataclasses
import json
import os
import warnings
import zlib
from collections.abc import Callable, Mapping
from functools import partial
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from simmpp.common.cache import cache_folder
from simmpp.common.errors import CacheWarning, WorkloadError
from simmpp.common.files import replaced
from simmpp.scene.check import check_scene
from simmpp.scene.scene import Scene
from simmpp.workload.check import check
from simmpp.workload.digest import digest_of
from simmpp.workload.picture import Picture
from simmpp.workload.trace.tracer import Progress, trace
from simmpp.workload.workload import ARRAYS, Workload, frozen

HEADER = b"workload"
"""Key of the metadata: name, digest, picture and, for each array, its shape and its CRC-32."""
DAMAGED = (OSError, ValueError, KeyError, TypeError, IndexError, pa.ArrowException)
"""What Arrow, JSON and numpy raise for a file that isn't, or is no longer, such a table."""


def workload_for(
    scene: Scene,
    picture: Picture,
    *,
    progress: Progress | None = None,
    notice: Callable[[str], None] | None = None,
) -> Workload:
    """The workload of ``picture``, from the cache if it is there, else traced and stored.

    ``notice`` (default: a warning) is told of a damaged file, which is made again, and of a cache
    that can't be written, which costs only the next run's time.
    """
    check_scene(scene)
    made = partial(trace, scene, picture, progress)
    return kept(scene.name, digest_of(scene, picture), made, notice)


def kept(
    name: str,
    digest: str,
    make: Callable[[], Workload],
    notice: Callable[[str], None] | None = None,
) -> Workload:
    """The workload of that digest, from the cache, else made and stored; ``notice`` as above."""
    tell = notice or (lambda text: warnings.warn(text, CacheWarning, stacklevel=4))
    path = cached_path(digest)
    if path.exists():
        try:
            cached = load(path)
            if cached.digest != digest:
                problem = "holds the workload of another scene or picture"
                raise WorkloadError(problem, where=str(path))
            return dataclasses.replace(cached, name=name)
        except WorkloadError as error:
            tell(f"{error}; tracing it again")
    workload = make()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        save(workload, path)
    except OSError as error:
        tell(f"{path.parent}: the workload is not cached: {error.strerror or error}")
    return workload


def save(workload: Workload, path: str | os.PathLike[str]) -> None:
    """Write ``workload`` to ``path``, whole or not at all; OSError if it can't be written."""
    arrays = {name: np.ascontiguousarray(getattr(workload, name)) for name in ARRAYS}
    header: dict[str, Any] = {
        "name": workload.name,
        "digest": workload.digest,
        "picture": workload.picture,
        "samples": workload.samples,
        "shapes": {name: array.shape for name, array in arrays.items()},
    }
    header["checksum"] = _checksum(header, arrays)
    row = pa.RecordBatch.from_arrays(list(map(_cell, arrays.values())), list(arrays))
    schema = row.schema.with_metadata({HEADER: json.dumps(header)})
    # Workers may write the same workload at once: each its own file, and the last one stays.
    with (
        replaced(Path(path)) as part,
        open(part, "wb") as file,
        pa.ipc.new_file(file, schema) as writer,
    ):
        writer.write_batch(row.replace_schema_metadata(schema.metadata))


def cached_path(digest: str) -> Path:
    """Where the workload of that digest is cached, if it is."""
    return cache_folder() / f"{digest}.arrow"


def load(path: str | os.PathLike[str]) -> Workload:
    """The workload that :func:`save` has written; its arrays are read-only pages of the file.

    Raises WorkloadError for a file that can't be read, is damaged, is no workload, or contradicts
    itself.
    """
    try:
        with open(path, "rb") as file:  # pyarrow itself opens names in UTF-8 only
            pages = mmap(file.fileno(), 0, access=ACCESS_READ)
        row = pa.ipc.open_file(pa.py_buffer(pages)).get_batch(0)  # keeps the pages
        row.validate(full=True)  # no array reaches beyond the file
        header = json.loads(row.schema.metadata[HEADER])
        shapes, checksum = header["shapes"], header.pop("checksum")
        arrays = {name: _entries(row[name]).reshape(shapes[name]) for name in ARRAYS}
        if checksum != _checksum(header, arrays):
            raise ValueError("damaged, its checksum does not fit")
        rows, columns = header["picture"]
        picture, samples = (rows, columns), header["samples"]
        workload = Workload(header["name"], header["digest"], picture, **arrays, samples=samples)
    except DAMAGED as error:
        problem = " ".join(str(error).split())[:200]
        raise WorkloadError(f"not a workload: {problem}", where=str(path)) from None
    check(workload, str(path))
    return frozen(workload)


def _cell(array: NDArray[Any]) -> pa.Array:
    """All entries of an array as one list."""
    return pa.LargeListArray.from_arrays(pa.array([0, array.size], pa.int64()), array.ravel())


def _entries(cell: pa.Array) -> NDArray[Any]:
    """The same back, on the pages of the file; pyarrow's own ``to_numpy`` would import pandas."""
    values = cell.flatten()
    dtype = np.dtype(values.type.to_pandas_dtype())
    buffer = values.buffers()[1]
    at = values.offset * dtype.itemsize
    return np.frombuffer(buffer, dtype, len(values), at) if len(values) else np.zeros(0, dtype)


def _checksum(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> int:
    """CRC-32 of all there is; SHA-256 would take ten times as long, longer than to read it."""
    checksum = zlib.crc32(json.dumps(header).encode())
    for array in arrays.values():
        checksum = zlib.crc32(array.data, zlib.crc32(array.dtype.str.encode(), checksum))
    return checksum
