"""Mistakes in hooks, each told in one line with file and line."""

from __future__ import annotations

import ast
import dis
import re
import traceback
from collections.abc import Iterator
from typing import Any

from numba.core.errors import NumbaError

from simmpp.common.errors import ConfigError
from simmpp.common.places import unknown
from simmpp.common.strict import in_words
from simmpp.common.units import shown
from simmpp.policy.policy import Hook, Policy
from simmpp.policy.table import POLICIES
from simmpp.policy.view import View


def refuse_unknown_fields(hook: Hook, policy: Policy, where: str) -> None:
    """Raise ConfigError if a hook reads what its view does not have."""
    known = {*View.__annotations__, *policy.parameters}
    for name, line in _fields_of(hook):
        if name not in known:
            problem = unknown(name, sorted(known)).replace("unknown key", "the view has no", 1)
            raise ConfigError(f"{hook.__name__}: {problem}", where=where, line=line)


def unknown_like(policy: Policy) -> str | None:
    """What is wrong with the policy that one says it is like; None: nothing."""
    if policy.like == "" or (isinstance(policy.like, str) and policy.like in POLICIES):
        return None
    expected = f"value {shown(policy.like)}: expected {in_words(tuple(POLICIES))}"
    return f"policy {policy.name!r}: like: {expected}"


def line_of_argument(text: str, name: str) -> int | None:
    """The first line of a source where a function is given an argument of that name."""
    calls = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call))
    given = (word.value.lineno for call in calls for word in call.keywords if word.arg == name)
    return min(given, default=None)


def _fields_of(hook: Hook) -> Iterator[tuple[str, int | None]]:
    """Fields of its argument that a hook itself names, with their lines."""
    code = hook.__code__
    view, before = code.co_varnames[0], None
    for instruction in dis.get_instructions(hook):
        if instruction.opname in ("LOAD_ATTR", "STORE_ATTR") and _loads(before, view):
            line = instruction.positions.lineno if instruction.positions else None
            yield str(instruction.argval), line
        before = instruction


def _loads(instruction: dis.Instruction | None, name: str) -> bool:
    """Does it put this variable on top?"""
    if instruction is None or not instruction.opname.startswith("LOAD_FAST"):
        return False
    loaded = instruction.argval
    return bool((loaded[-1] if isinstance(loaded, tuple) else loaded) == name)


def not_compiled(error: Exception, hook: Hook) -> ConfigError:
    """The line for a hook that numba can't compile."""
    code = hook.__code__
    told = re.search(r" Raised from .* \((\d+)\)", str(error))
    line = int(told[1]) if told else getattr(getattr(error, "loc", None), "line", None)
    said = [text for text in str(error).splitlines() if text.strip()]
    if isinstance(error, NumbaError) and len(said) > 1 and said[0].startswith("Failed in"):
        del said[0]
    problem = re.sub(r"Record\(now_ps\[.*\)", "the view", said[0] if said else type(error).__name__)
    problem = re.sub(r" Raised from .*", "", problem)
    problem = re.sub(r" for '\$.*", ", expected a whole number", problem)
    return ConfigError(
        f"{hook.__name__} can't be compiled: {problem[:300]}",
        where=file_of(hook),
        line=line or code.co_firstlineno,
    )


_copies: dict[str, str] = {}


def note_copy(copy: str, where: str) -> None:
    """A file lies in the cache too: what is wrong in the copy is told of the file."""
    _copies[copy] = where


def file_of(hook: Hook) -> str:
    """The file of a hook, as its user knows it."""
    name: str = hook.__code__.co_filename
    return _copies.get(name, name)


def line_in(file: str, error: BaseException) -> int | None:
    """The line of a file in which an exception was raised, as far as it was."""
    frames: list[Any] = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    return lines[-1] if lines else None
