"""Hooks as compiled code calls them: C functions of one record, by their address."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from fractions import Fraction
from functools import cache
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from simmpp.common.compiled import cfunc
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.policy import Hook, Policy
from simmpp.policy.view import GROUPS, LOADS, WORDS, View

_DEFAULTS = PolicyParameters("object")
NUMBERS = tuple(
    field.name
    for field in fields(_DEFAULTS)
    if type(getattr(_DEFAULTS, field.name)) in (int, Fraction)
)
"""Parameters that hooks may read: those whose default is a number."""
_SEVERAL = ("parameter", "memory")
VIEW = np.dtype(
    [(name, "i8", (WORDS,)) if name in _SEVERAL else (name, "i8") for name in View.__annotations__]
)
"""A ``View`` in memory."""
_RECORD = numba.from_dtype(VIEW)


@cache
def address_of(hook: Hook | None, parameters: tuple[str, ...] = ()) -> int:
    """The machine code of a hook; 0 for one that the policy does not have.

    The policy's own ``parameters`` are words of the record that have names as well.
    """
    if hook is None:
        return 0
    compiled: Any = cfunc(types.int64(_with_names(parameters)))(hook)
    return int(compiled.address)


def _with_names(parameters: tuple[str, ...]) -> Any:
    """The type of the record, each parameter also a field of its own at the same place."""
    if not parameters:
        return _RECORD
    known: Any = VIEW.fields
    formats: dict[str, tuple[Any, int]] = {name: known[name][:2] for name in known}
    first = formats["parameter"][1]
    formats |= {name: (np.dtype("i8"), first + 8 * n) for n, name in enumerate(parameters)}
    dtypes, offsets = zip(*formats.values(), strict=True)
    layout: Any = {"names": list(formats), "formats": list(dtypes), "offsets": list(offsets)}
    return numba.from_dtype(np.dtype(layout | {"itemsize": VIEW.itemsize}))


@intrinsic
def consult(typing_context: Any, address: Any, view: Any) -> Any:
    """Call the hook at ``address`` with a VIEW record, which goes as a pointer.

    A hook passed as a first-class function would cost microseconds to unwrap at every call from
    Python, and one compiled into its caller would leave that caller's cache stale when it changes.
    """

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = context.get_value_type(_RECORD)
        hook = ir.FunctionType(ir.IntType(64), [pointer]).as_pointer()
        return builder.call(builder.inttoptr(values[0], hook), [values[1]])

    return types.int64(types.int64, _RECORD), call


# --- what a hook reads ---


def groups_read(hook: Hook | None) -> int:
    """The groups of the view's fields that a hook reads, as one number."""
    read = names_in(hook)
    return sum(group for group, names in GROUPS.items() if not read.isdisjoint(names))


def reads(policy: Policy, *names: str) -> bool:
    """Does any hook of the policy read one of these fields?"""
    return any(not names_in(hook).isdisjoint(names) for hook in (policy.send, policy.ask))


def knows_loads(policy: Policy) -> bool:
    """Does it read loads of others? Without, headers are not remembered."""
    return reads(policy, *GROUPS[LOADS])


@cache
def names_in(hook: Hook | None) -> frozenset[str]:
    """All names in a hook and in what it calls: compiled code has no other way to a field."""
    names: set[str] = set()
    for function in functions_of(hook):
        for code in _codes(function.__code__):
            names.update(code.co_names)
    return frozenset(names)


def functions_of(hook: object) -> list[FunctionType]:
    """A hook and the functions of Python that it calls, directly or not."""
    found: dict[FunctionType, None] = {}
    pending = [hook]
    while pending:
        function = getattr(called := pending.pop(), "py_func", called)
        if isinstance(function, FunctionType) and function not in found:
            found[function] = None
            pending += [value for _, value in globals_of(function)]
    return list(found)


def globals_of(function: FunctionType) -> Iterator[tuple[str, object]]:
    """What a function reads of its surroundings, by name: of modules, what it may read of them."""
    for code in _codes(function.__code__):
        cells = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
        for name in (*code.co_names, *cells):
            value = cells[name].cell_contents if name in cells else function.__globals__.get(name)
            if isinstance(value, ModuleType):
                members = ((name, getattr(value, name, None)) for name in code.co_names)
                yield from ((name, member) for name, member in members if member is not None)
            elif value is not None:
                yield name, value


def _codes(code: CodeType) -> Iterator[CodeType]:
    """A function's code and that of the functions in it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)
