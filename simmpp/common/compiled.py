"""How simmpp compiles: numba, IEEE arithmetic as written, kept on disk between runs.

numba notices that a function's own file has changed, but not the files of the functions that it
calls or of the constants that it reads. So compiled code is kept in a folder named after the source
of a module and of all that it imports: what is stale is never found. Copies of the package, as the
installed one and a checkout, find each other's code.
"""

from __future__ import annotations

import ast
import hashlib
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from filelock import FileLock
from llvmlite.binding import Linkage
from numba.core.caching import FunctionCache, _CacheLocator
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher

from simmpp.common.cache import cache_folder
from simmpp.common.errors import CacheWarning
from simmpp.common.interrupts import Uninterrupted

Function = TypeVar("Function", bound=Callable[..., object])

PACKAGE = __name__.partition(".")[0]
OPTIONS = {"nopython": True, "error_model": "numpy", "nogil": True}


class _Compiled(CPUDispatcher):  # type: ignore[misc]
    """Is compiled once, whoever calls it: all integers are int64, and no number is a type.

    Left alone, numba would compile a function, and all that it calls, again for the int32 of a
    record's field and for a number written at the call.
    """

    def __call__(self, *args: Any, **kws: Any) -> Any:
        """Compile if need be, and run; an interrupt waits, for numba would lose it or half a code.

        While it compiles numba calls back Python from LLVM, which knows no exceptions.
        """
        with Uninterrupted():
            return super().__call__(*args, **kws)

    def compile(self, sig: Any) -> Any:
        """Compile; likewise."""
        with Uninterrupted():
            return super().compile(sig)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """What numba asks for a call from compiled code."""
        template, signature, _, rest = super().get_call_template(tuple(map(_widened, args)), kws)
        return template, signature, args, rest


class _Kept(FunctionCache):  # type: ignore[misc]
    """numba's cache on disk; one that is full or breaks costs the next run's time, no more."""

    @contextmanager
    def _guard_against_spurious_io_errors(self) -> Iterator[None]:
        """What numba loads and saves within."""
        try:
            yield
        except OSError as error:
            _tell_of_cache(error.strerror or str(error))


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
def _tell_of_cache(reason: str) -> None:
    text = f"{cache_folder()}: compiled code is not kept: {reason}"
    warnings.warn(text, CacheWarning, stacklevel=2)


class _Part(JITCodeLibrary):  # type: ignore[misc]
    """Instructions of a kernel, as they were written.

    They are optimised and made machine code once, with all that calls them. Left alone, numba does
    so for each kernel by itself, and for all that it calls again: half the time of compiling.
    """

    def _optimize_final_module(self) -> None:
        """Nothing yet."""

    def _finalize_final_module(self) -> None:
        """Callers may have them."""
        self._finalized = True

    @property
    def codegen(self) -> _Part:
        """Who is given Python's globals for the machine code that there isn't."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """Nobody needs them."""


class _Whole(JITCodeLibrary):  # type: ignore[misc]
    """Instructions of what Python calls, with all that it calls, which nobody else can call.

    So a kernel that is called from one place is put there.
    """

    def _optimize_final_module(self) -> None:
        for function in self._final_module.functions:
            if function.linkage == Linkage.linkonce_odr:
                function.linkage = Linkage.internal
        super()._optimize_final_module()


class _KernelCompiler(Compiler):  # type: ignore[misc]
    """numba's compiler, for such parts."""

    def __init__(self, typing: Any, target: Any, _library: object, *rest: Any) -> None:
        super().__init__(typing, target, _Part(target.codegen(), "kernel"), *rest)


class _WholeCompiler(Compiler):  # type: ignore[misc]
    """The same, for what is whole."""

    def __init__(self, typing: Any, target: Any, _library: object, *rest: Any) -> None:
        whole = _Whole(target.codegen(), "whole")
        whole.enable_object_caching()
        super().__init__(typing, target, whole, *rest)


class _Kernel(_Compiled):
    """Has no code that Python could call."""

    def __call__(self, *args: object) -> object:
        """Refuse: without this, Python would jump to address 0."""
        raise TypeError(f"{self.__name__} is called by compiled code only")


def _widened(kind: Any) -> Any:
    kind = numba.types.unliteral(kind)
    return numba.types.int64 if isinstance(kind, numba.types.Integer) else kind


def njit(function: Function) -> Function:
    """Compile ``function`` on first use, and keep it on disk with all that it calls.

    For what Python calls. It may make arrays. No fastmath: results must not depend on the CPU.
    """
    if numba.config.DISABLE_JIT:
        return function
    return _cached(function, {"_nrt": True})


def _cached(function: Function, options: dict[str, bool]) -> Function:
    compiled: Any = _Compiled(
        function, targetoptions=OPTIONS | options, pipeline_class=_WholeCompiler
    )
    with _kept_for(function) as kept:
        if kept:
            compiled._cache = _Kept(function)  # what enable_caching does with numba's own
    return cast(Function, compiled)


def kernel(function: Function) -> Function:
    """:func:`njit` for what only compiled code calls, and what makes no arrays.

    It is kept within its callers. To compile it takes half the time: it has no wrappers for Python
    and C. Its calls count no references: a search of a tree that calls one for each box takes a
    third of the time, a run of the engines four fifths.
    """
    if numba.config.DISABLE_JIT:
        return function
    without = {"_nrt": False, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    options = {"targetoptions": OPTIONS | without, "pipeline_class": _KernelCompiler}
    return cast(Function, _Kernel(function, **options))


def cfunc(signature: object, key: str) -> Callable[[Callable[..., object]], object]:
    """Compile a function of that numba signature which compiled code calls by its address.

    ``key`` tells apart what its module's source does not: the values that it takes from around it.
    """

    def compile_now(function: Callable[..., object]) -> object:
        with _kept_for(function, key) as kept, Uninterrupted():
            try:
                return numba.cfunc(signature, cache=kept, boundscheck=True)(function)
            except OSError as error:
                _tell_of_cache(error.strerror or str(error))
                return numba.cfunc(signature, boundscheck=True)(function)

    return compile_now


@contextmanager
def _kept_for(function: Callable[..., object], key: str = "") -> Iterator[bool]:
    """Tell numba where to keep what is decorated here; False if nothing can be kept.

    Left alone, numba would then keep it beside the source, under no digest. Other packages'
    functions are kept where they were. What is typed into an interactive session has no source
    whose digest could name a folder.
    """
    before = numba.config.CACHE_DIR, numba.config.CACHE_LOCATOR_CLASSES
    kept = _file(function.__module__) is not None
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


def _closure(module: str) -> set[str]:
    """The module and all modules of this package that it imports, directly or not."""
    closure: set[str] = set()
    pending = [module]
    while pending:
        name = pending.pop()
        if name not in closure:
            closure.add(name)
            pending.extend(_imports(_source(name)))
    return closure


@cache
def _imports(source: str) -> frozenset[str]:
    """Modules of this package that a source imports, wherever in it: functions import, too.

    What only type checkers read is left out. Kept, as parsing takes milliseconds and every compiled
    function asks for the digest of its module.
    """
    modules: set[str] = set()
    pending: list[ast.AST] = [ast.parse(source)]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        pending.extend(ast.iter_child_nodes(node))
        if isinstance(node, ast.Import):
            modules.update(filter(_is_ours, (alias.name for alias in node.names)))
        elif isinstance(node, ast.ImportFrom) and _is_ours(node.module or ""):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            modules.update(name if _file(name) else str(node.module) for name in names)
    return frozenset(modules)


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] == PACKAGE


@cache
def _source(module: str) -> str:
    """The text of one module. Raise a ModuleNotFoundError if it has no file.

    A digest that left it out would find stale code and stale workloads for ever.
    """
    file = _file(module)
    if file is None:
        raise ModuleNotFoundError(f"no file holds the source of {module}")
    return file.read_text(encoding="utf-8")


@cache
def _file(module: str) -> Path | None:
    """Where a module's source is; others than this package's have to be imported already."""
    if _is_ours(module):
        path = Path(__file__).parents[1].joinpath(*module.split(".")[1:])
        files = (path.with_suffix(".py"), path / "__init__.py")
        return next((file for file in files if file.is_file()), None)
    loaded = getattr(sys.modules.get(module), "__file__", None)
    return Path(loaded) if loaded else None


# --- calling compiled functions from Python many times a second ---


def entry_point(function: Any, *arguments: Any) -> Callable[..., Any]:
    """The machine code of ``function`` for arguments of these types, callable from Python.

    numba's own dispatch works out the types of its arguments at every call, about a microsecond
    for the one record array that holds a state: as long as a short activity itself takes.
    Arguments of other types must never be passed.
    """
    signature = tuple(numba.typeof(argument) for argument in arguments)
    function.compile(signature)
    return function.overloads[signature].entry_point
