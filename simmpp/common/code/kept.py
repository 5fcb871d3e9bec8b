"""Where machine code is kept: in a folder named after the source that it is of.

numba notices that a function's own file has changed, but not the files of the functions that it
calls or of the constants that it reads. So the folder's name is a digest of a module and of all
that it imports: what is stale is never found. Copies of the package, as the installed one and a
checkout, find each other's code.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path

import numba
from filelock import FileLock
from numba.core.caching import FunctionCache, _CacheLocator

from simmpp.common.cache import cache_folder
from simmpp.common.code.source import file_of, source_digest
from simmpp.common.errors import CacheWarning


class Kept(FunctionCache):  # type: ignore[misc]
    """numba's cache on disk; one that is full or breaks costs the next run's time, no more."""

    @contextmanager
    def _guard_against_spurious_io_errors(self) -> Iterator[None]:
        """What numba loads and saves within."""
        try:
            yield
        except OSError as error:
            tell_of_cache(error.strerror or str(error))


class ByDigest(_CacheLocator):  # type: ignore[misc]
    """Where numba keeps a function's code: in the folder that is set now, wherever its source lies.

    numba's own locators tell apart equal sources by their paths and times.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        self._folder = numba.config.CACHE_DIR
        self._line = function.__code__.co_firstlineno

    @classmethod
    def from_function(cls, function: Callable[..., object], _file: str) -> ByDigest:
        """Numba's constructor."""
        return cls(function)

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Nothing: the folder's name is a digest of the source."""
        return ""

    def get_disambiguator(self) -> str:
        """What tells apart functions of one name in one module."""
        return str(self._line)


@cache  # told once
def tell_of_cache(reason: str) -> None:
    """Warn that the next run compiles again."""
    text = f"{cache_folder()}: compiled code is not kept: {reason}"
    warnings.warn(text, CacheWarning, stacklevel=2)


@contextmanager
def kept_for(function: Callable[..., object], key: str = "") -> Iterator[bool]:
    """Tell numba where to keep what is decorated here; False if nothing can be kept.

    Left alone, numba would then keep it beside the source, under no digest. Other packages'
    functions are kept where they were. What is typed into an interactive session has no source
    whose digest could name a folder.
    """
    before = numba.config.CACHE_DIR, numba.config.CACHE_LOCATOR_CLASSES
    kept = file_of(function.__module__) is not None
    if kept:
        folder = _folder(function.__module__) / key
        numba.config.CACHE_DIR = str(folder)
        numba.config.CACHE_LOCATOR_CLASSES = f"{__name__}.{ByDigest.__name__}"
        kept = _is_writable(folder)
    try:
        yield kept
    finally:
        numba.config.CACHE_DIR, numba.config.CACHE_LOCATOR_CLASSES = before


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


def keeps_code() -> bool:
    """Can machine code be kept for the next run?"""
    return _is_writable(_folder(__name__))


def is_compiled(module: str) -> bool:
    """Has machine code of this module, as it is now, been kept by an earlier run?"""
    return any(_folder(module).rglob("*.nbi"))


@contextmanager
def compiled_by_one(module: str) -> Iterator[None]:
    """If code of this module is missing, wait for the process that makes it; it is found then."""
    with ExitStack() as held:
        if not is_compiled(module) and keeps_code():
            with suppress(OSError, NotImplementedError):  # some shared file systems have no locks
                held.enter_context(FileLock(_folder(module) / "lock"))
        yield


def _folder(module: str) -> Path:
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    root = Path(chosen) if chosen else cache_folder() / "compiled"
    return root / source_digest(module)
