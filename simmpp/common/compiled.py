"""How simmpp compiles: numba, IEEE arithmetic as written, kept on disk between runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.core.registry import CPUDispatcher

from simmpp.common.code.kept import Kept, kept_for, tell_of_cache
from simmpp.common.code.whole import KernelCompiler, WholeCompiler
from simmpp.common.interrupts import Uninterrupted

Function = TypeVar("Function", bound=Callable[..., object])

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
        function, targetoptions=OPTIONS | options, pipeline_class=WholeCompiler
    )
    with kept_for(function) as kept:
        if kept:
            compiled._cache = Kept(function)  # what enable_caching does with numba's own
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
    options = {"targetoptions": OPTIONS | without, "pipeline_class": KernelCompiler}
    return cast(Function, _Kernel(function, **options))


def cfunc(signature: object, key: str) -> Callable[[Callable[..., object]], object]:
    """Compile a function of that numba signature which compiled code calls by its address.

    ``key`` tells apart what its module's source does not: the values that it takes from around it.
    """

    def compile_now(function: Callable[..., object]) -> object:
        with kept_for(function, key) as kept, Uninterrupted():
            try:
                return numba.cfunc(signature, cache=kept, boundscheck=True)(function)
            except OSError as error:
                tell_of_cache(error.strerror or str(error))
                return numba.cfunc(signature, boundscheck=True)(function)

    return compile_now


def entry_point(function: Any, *arguments: Any) -> Callable[..., Any]:
    """The machine code of ``function`` for arguments of these types, callable from Python.

    numba's own dispatch works out the types of its arguments at every call, about a microsecond
    for the one record array that holds a state: as long as a short activity itself takes.
    Arguments of other types must never be passed.
    """
    signature = tuple(numba.typeof(argument) for argument in arguments)
    function.compile(signature)
    return function.overloads[signature].entry_point
