"""How simmpp compiles: numba, IEEE arithmetic as written, kept on disk between runs.

numba notices that a function's own file has changed, but not the files of the functions that it
calls or of the constants that it reads. So compiled code is kept in a folder named after the source
of a module and of all that it imports: what is stale is never found.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TypeVar

import numba
from platformdirs import user_cache_path

Function = TypeVar("Function", bound=Callable[..., object])

_PACKAGE = Path(__file__).parent
_IMPORT = re.compile(r"^(?:from|import) (simmpp[\w.]*)", re.MULTILINE)


def njit(function: Function) -> Function:
    """Compile ``function`` on first use; no fastmath: results must not depend on the CPU.

    It may make arrays, whoever calls it: left alone, numba would take that from the first caller.
    """
    with _kept_in(_folder(function.__module__)) as kept:
        return numba.njit(cache=kept, error_model="numpy", nogil=True, _nrt=True)(function)


def njit_reading(function: Function) -> Function:
    """:func:`njit` for functions that make no arrays: their calls count no references.

    A search of a tree that calls one for each box takes a third of the time, a run of the engines,
    all of whose arrays are made beforehand, four fifths.
    """
    with _kept_in(_folder(function.__module__)) as kept:
        return numba.njit(cache=kept, error_model="numpy", nogil=True, _nrt=False)(function)


def cfunc(signature: object) -> Callable[[Callable[..., object]], object]:
    """Compile a function of that numba signature which compiled code calls by its address."""

    def compile_now(function: Callable[..., object]) -> object:
        with _kept_in(_folder(function.__module__)) as kept:
            return numba.cfunc(signature, cache=kept)(function)

    return compile_now


@contextmanager
def _kept_in(folder: Path) -> Iterator[bool]:
    """Tell numba where to keep what is decorated here; False if nothing can be kept there.

    Left alone, numba would then keep it beside the source, under no digest. Other packages'
    functions are kept where they were.
    """
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        yield _is_writable(folder)
    finally:
        numba.config.CACHE_DIR = before


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


def cache_folder() -> Path:
    """Where workloads and compiled code are kept: SIMMPP_CACHE, XDG_CACHE_HOME or the user's."""
    chosen, xdg = os.environ.get("SIMMPP_CACHE"), os.environ.get("XDG_CACHE_HOME")
    if chosen:
        return Path(chosen)
    return Path(xdg) / "simmpp" if xdg else user_cache_path("simmpp", appauthor=False)


def source_digest(*modules: str) -> str:
    """Hexadecimal hash of the source of modules and of all that they import of this package."""
    digest = hashlib.sha256()
    for name in sorted(set[str]().union(*map(_closure, modules))):
        digest.update(_source(name).encode())
    return digest.hexdigest()[:16]


def keeps_code() -> bool:
    """Can machine code be kept for the next run?"""
    return _is_writable(_folder(__name__))


def is_compiled(module: str) -> bool:
    """Has machine code of this module, as it is now, been kept by an earlier run?"""
    return any(_folder(module).rglob("*.nbi"))


def _folder(module: str) -> Path:
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    root = Path(chosen) if chosen else cache_folder() / "compiled"
    return root / source_digest(module)


def _closure(module: str) -> set[str]:
    """The module and all modules of this package that it imports, directly or not."""
    found: set[str] = set()
    pending = [module]
    while pending:
        name = pending.pop()
        if name not in found:
            found.add(name)
            pending.extend(_IMPORT.findall(_source(name)))
    return found


@cache
def _source(module: str) -> str:
    """The text of one module; empty where it has no file (an interactive session)."""
    path = _PACKAGE.joinpath(*module.split(".")[1:])
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file.read_text(encoding="utf-8")
    return ""
