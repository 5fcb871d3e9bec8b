"""Where a key was written, and the errors that say so: file, line, key, then the problem."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown

KeyPath = tuple[str | int, ...]
"""Keys and indices from the top of a document."""
Place = tuple[str, int | None]
"""Where a key was set: a file, ``--set KEY`` or an option named as the key ends; and the line."""


def misplaced(
    path: KeyPath, problem: str, places: Mapping[KeyPath, Place], *, within: bool = False
) -> ConfigError:
    """The error for the key at ``path``; ``problem`` follows it in the line.

    With ``within`` the problem names the key itself, and what holds it is named before.
    """
    path = _as_written(path, places)
    where, line = places.get(path, ("", None))
    key = dotted(path[:-1] if within else path)
    last = key.rpartition(".")[2]
    is_named = where == f"--set {key}" or (where[:2] == "--" and last.startswith(where[2:]))
    prefix = "" if not key or is_named else f"{key}: "
    return ConfigError(prefix + problem, where=where, line=line)


def dotted(path: KeyPath) -> str:
    """``("policy", 1, "batch")`` -> ``policy[1].batch``."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{_plain(part)}" for part in path)
    return text.removeprefix(".")


def _plain(part: str) -> str:
    return part if part.isprintable() else repr(part)


def _as_written(path: KeyPath, places: Mapping[KeyPath, Place]) -> KeyPath:
    """As far as the user wrote it: short forms have neither the indices nor the last keys."""
    written: KeyPath = ()
    for part in path:
        if not places or (*written, part) in places:
            written = (*written, part)
    return written


def unknown(key: str, known: list[str]) -> str:
    """The problem with a key that doesn't exist: the nearest that does, or all."""
    near = get_close_matches(key, known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"expected one of {', '.join(known)}"
    return f"unknown key {shown(key)}: {hint}"
