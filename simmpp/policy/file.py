"""Policies of one's own: a Python file, read, run and known by what is in it.

A file is code: whoever reads it runs it. Its text travels to the workers of a sweep, and a copy is
kept in the cache, where numba keeps what it compiles of it. What it is goes by its digest: that of
the text, and of the constants and functions that its hooks take from elsewhere.
"""

from __future__ import annotations

import contextlib
import hashlib
import inspect
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from simmpp.common.cache import cache_folder
from simmpp.common.errors import ConfigError
from simmpp.common.files import refuse_special, write_text
from simmpp.common.units import shown
from simmpp.policy.endless import counted
from simmpp.policy.mistakes import (
    line_in,
    line_of_argument,
    note_copy,
    refuse_unknown_fields,
    unknown_like,
)
from simmpp.policy.policy import Hook, Policy
from simmpp.policy.reads import functions_of, globals_of

OBJECT = "POLICY"
"""The name in a file of what it is about."""
MOST_CHARACTERS = 200_000


@dataclass(frozen=True)
class PolicyFile:
    """A file with a policy, as small as can be sent to another machine."""

    path: str
    """As users write it."""
    text: str
    digest: str
    where: str = field(compare=False)
    """Where it was read, for errors."""


def read_policy(path: str, folder: Path = Path()) -> PolicyFile:
    """Read a file, looked for from ``folder``, and run it.

    Raises ConfigError if it can't be read, and for what is wrong in it, with file and line.
    """
    where = folder / path
    try:
        refuse_special(where)
        text = where.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "no text in UTF-8"
        problem = f"value {shown(path)}: expected the Python file of a policy: {reason}"
        raise ConfigError(problem) from None
    if len(text) > MOST_CHARACTERS:
        raise ConfigError(f"value {shown(path)}: expected at most {MOST_CHARACTERS} characters")
    policy = _policy_in(text, str(where))
    return PolicyFile(path, text, digest_of(policy, text), str(where))


def policy_of_file(file: PolicyFile) -> Policy:
    """The policy of a file that was read here or elsewhere.

    Raises ConfigError for a mistake in it, and if it reads other constants here than there.
    """
    policy = _policy_in(file.text, file.where)
    if digest_of(policy, file.text) != file.digest:
        raise ConfigError("reads other constants here than where it was read", where=file.where)
    return policy


def digest_of(policy: Policy, text: str | None = None) -> str:
    """Hexadecimal hash of what decides what a policy does; ``text`` is that of its file."""
    home = "" if text is None else _module_of(text)
    parts = [text or "", *sorted(set(_of_elsewhere(policy, home)))]
    if text is None:  # which says these
        said = {k: v for k, v in vars(policy).items() if not callable(v)}
        parts.append(repr(sorted(said.items())))
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _of_elsewhere(policy: Policy, home: str) -> Iterator[str]:
    """What hooks take from around them, and what is not in the policy's file."""
    for what, hook in policy.hooks.items():
        yield from (f"{what} {said}" for said in _around(hook, home))


def key_of(hook: Hook) -> str:
    """Hexadecimal hash of the functions and constants that a hook is made of: compiled code has
    them in it."""
    return hashlib.sha256("\0".join(sorted(set(_around(hook, "")))).encode()).hexdigest()[:16]


def _around(hook: Hook, home: str) -> Iterator[str]:
    for function in functions_of(hook):
        if function.__module__ != home:
            yield _source_of(function)
        for name, value in globals_of(function):
            if isinstance(value, int | float | str | bytes | tuple | np.generic | np.ndarray):
                yield f"{name} {_said(value)}"


def _said(value: Any) -> str:
    """A constant in full, without addresses."""
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    if isinstance(value, tuple):
        return f"({', '.join(map(_said, value))})"
    return repr(value) if isinstance(value, int | float | str | bytes | np.generic) else ""


def _module_of(text: str) -> str:
    """The name under which a file of that text is imported."""
    return f"simmpp_policy_{hashlib.sha256(text.encode()).hexdigest()[:32]}"


def _source_of(function: Any) -> str:
    try:
        return inspect.getsource(function)
    except (OSError, TypeError):  # typed into an interactive session
        code = function.__code__
        return f"{code.co_code.hex()} {code.co_consts} {code.co_names}"


@lru_cache(maxsize=64)  # every point of a sweep asks again
def _policy_in(text: str, where: str) -> Policy:
    digest = hashlib.sha256(text.encode()).hexdigest()[:32]
    module = ModuleType(f"simmpp_policy_{digest}")
    path = _kept(text, digest, Path(where).name)
    if path is not None:
        module.__file__ = str(path)
    sys.modules[module.__name__] = module  # where numba looks for a function's file
    name = str(path) if path else where
    note_copy(name, where)
    try:
        exec(compile(counted(text, name), name, "exec"), module.__dict__)
    except SyntaxError as error:
        raise ConfigError(error.msg, where=where, line=error.lineno) from None
    except ConfigError as error:
        raise ConfigError(str(error), where=where, line=line_in(name, error)) from None
    except (Exception, SystemExit) as error:
        problem = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise ConfigError(problem, where=where, line=line_in(name, error)) from None
    policy = getattr(module, OBJECT, None)
    if not isinstance(policy, Policy):
        raise ConfigError(f"expected {OBJECT} = Policy(...)", where=where)
    if unlike := unknown_like(policy):
        raise ConfigError(unlike, where=where, line=line_of_argument(text, "like"))
    for hook in policy.hooks.values():
        refuse_unknown_fields(hook, policy, where)
    return policy


def _kept(text: str, digest: str, name: str) -> Path | None:
    """A copy in the cache, under its digest; None if nothing can be written there."""
    path = cache_folder() / "policies" / digest / name
    with contextlib.suppress(OSError):
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_text(text, path)
        return path
    return None
