"""What hooks read: fields of the view, and what stands around them in their files.

Compiled code has no way to a field but its name, so the names in a function and in all that it
calls are at least those that it reads.
"""

from __future__ import annotations

import dis
from collections.abc import Iterator
from functools import cache
from types import CodeType, FunctionType, ModuleType

from simmpp.policy.policy import Hook, Policy
from simmpp.policy.view import GROUPS, LOADS, NUMBERS


def groups_read(hook: Hook | None) -> int:
    """The groups of the view's fields that a hook reads, as one number."""
    read = names_in(hook)
    return sum(group for group, names in GROUPS.items() if not read.isdisjoint(names))


def reads(policy: Policy, *names: str) -> bool:
    """Does any hook of the policy read one of these fields?"""
    return any(not names_in(hook).isdisjoint(names) for hook in policy.hooks.values())


def numbers_read(policy: Policy) -> list[str]:
    """The numbers of ``PolicyParameters`` that decide what it does."""
    return [name for name in NUMBERS if name in policy.counts or reads(policy, name)]


def knows_loads(policy: Policy) -> bool:
    """Does it read loads of others, or go by them? Without, headers are not remembered."""
    return policy.to_holders or reads(policy, *GROUPS[LOADS])


def settings_used(policy: Policy, *, steals: bool = False) -> tuple[str, ...]:
    """The settings that make a difference to it: those that its hooks read, or that say when these
    are asked, and what may be packed or merged. Who steals goes by the loads that it knows."""
    used = [name for name in NUMBERS if name in policy.counts or reads(policy, name)]
    used += ["load_info"] if steals or knows_loads(policy) else []
    used += ["steal"] if steals else []
    used += ["merge_requests"] if policy.asks else []
    return (*used, *(["packing"] if len(policy.packings) > 1 else []))


@cache
def names_in(hook: Hook | None) -> frozenset[str]:
    """All names in a hook and in what it calls."""
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
    cells = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
    for code in _codes(function.__code__):
        value: object = None
        for step in dis.get_instructions(code):
            name = str(step.argval)
            if step.opname == "EXTENDED_ARG":
                continue
            if step.opname in ("LOAD_GLOBAL", "LOAD_DEREF"):
                is_cell = name in cells and step.opname == "LOAD_DEREF"
                value = cells[name].cell_contents if is_cell else function.__globals__.get(name)
            elif step.opname in ("LOAD_ATTR", "LOAD_METHOD") and isinstance(value, ModuleType):
                value = getattr(value, name, None)
            else:
                value = None
            if value is not None and not isinstance(value, ModuleType):
                yield name, value


def _codes(code: CodeType) -> Iterator[CodeType]:
    """A function's code and that of the functions in it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _codes(constant)
