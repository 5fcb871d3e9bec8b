"""Workloads on disk: one uncompressed npz each, checked when read, kept in the user's cache."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import os
import tempfile
import warnings
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import cache_folder
from simmpp.common.errors import WorkloadError
from simmpp.scene.check import check_scene
from simmpp.scene.scene import Scene
from simmpp.workload.cache.aligned_npz import map_arrays, write_aligned
from simmpp.workload.check import check
from simmpp.workload.digest import digest_of
from simmpp.workload.picture import Picture
from simmpp.workload.trace.tracer import Progress, trace
from simmpp.workload.workload import Workload, frozen

TEXTS = ("name", "digest", "picture")
"""Fields of a workload that are no arrays; they are stored in ``header``."""
DAMAGED = (
    *(OSError, ValueError, KeyError, EOFError, TypeError),
    *(RuntimeError, zipfile.BadZipFile, zlib.error),  # such as an encrypted or a compressed member
)
"""What numpy and zipfile raise for a file that isn't, or is no longer, an npz of arrays."""


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
    tell = notice or (lambda text: warnings.warn(text, stacklevel=3))
    digest = digest_of(scene, picture)
    path = cached_path(digest)
    if path.exists():
        try:
            return dataclasses.replace(_expected(load(path), digest, path), name=scene.name)
        except WorkloadError as error:
            tell(f"{error}; tracing it again")
    workload = trace(scene, picture, progress)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        save(workload, path)
    except OSError as error:
        tell(f"{path.parent}: the workload is not cached: {error.strerror or error}")
    return workload


def save(workload: Workload, path: str | os.PathLike[str]) -> None:
    """Write ``workload`` to ``path``, whole or not at all.

    Raises
    ------
    OSError
        The file can't be written.
    """
    arrays = {name: getattr(workload, name) for name in _array_names()}
    header = [workload.name, workload.digest, *map(str, workload.picture), _checksum(arrays)]
    target = Path(path)
    handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=target.name, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            write_aligned(file, {"header": np.array(header), **arrays})
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


def cached_path(digest: str) -> Path:
    """Where the workload of that digest is cached, if it is."""
    return cache_folder() / f"{digest}.npz"


def load(path: str | os.PathLike[str]) -> Workload:
    """Read a workload that :func:`save` has written.

    Raises
    ------
    WorkloadError
        The file can't be read, is damaged, is no workload, or contradicts itself.
    """
    workload, checksum = _read(path, _arrays)
    if checksum != _checksum({name: getattr(workload, name) for name in _array_names()}):
        raise WorkloadError("damaged: its checksum does not fit", where=str(path))
    check(workload, str(path))
    return workload


def open_workload(path: str | os.PathLike[str]) -> Workload:
    """Like :func:`load`, but the arrays are the file's own pages: processes share them.

    Damage is noticed by the archive's CRC-32, which takes a tenth of the time of SHA-256.
    """
    workload, _ = _read(path, map_arrays)
    check(workload, str(path))
    return workload


def _read(
    path: str | os.PathLike[str], read: Callable[[Path], dict[str, NDArray[Any]]]
) -> tuple[Workload, str]:
    """A workload file as it is, and the checksum that it says."""
    try:
        arrays = read(Path(path))
        name, digest, rows, columns, checksum = map(str, arrays.pop("header"))
        picture = int(rows), int(columns)
        arrays = {name: arrays[name] for name in _array_names()}
    except DAMAGED as error:
        problem = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise WorkloadError(f"not a workload: {problem}", where=str(path)) from None
    return frozen(Workload(name=name, digest=digest, picture=picture, **arrays)), checksum


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in ("header", *_array_names())}


def _expected(workload: Workload, digest: str, path: Path) -> Workload:
    if workload.digest != digest:
        raise WorkloadError("holds the workload of another scene or picture", where=str(path))
    return workload


def _array_names() -> list[str]:
    return [field.name for field in dataclasses.fields(Workload) if field.name not in TEXTS]


def _checksum(arrays: dict[str, np.ndarray]) -> str:
    """SHA-256 of names, types, shapes and bytes, the same on every byte order."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        digest.update(f"{name} {array.dtype.str[1:]} {array.shape}".encode())
        digest.update(array.astype(array.dtype.newbyteorder("<"), copy=False).data)
    return digest.hexdigest()
