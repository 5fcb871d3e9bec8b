"""Policies of one's own in a configuration: the files that it names are read, once it may."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.places import KeyPath, Place, misplaced
from simmpp.common.strict import is_line
from simmpp.common.units import shown
from simmpp.policy.file import read_policy

FILE = "file"


def with_files(
    data: Mapping[str, Any],
    places: Mapping[KeyPath, Place],
    folder_of: Callable[[KeyPath], Path],
    *,
    may_run: bool,
) -> dict[str, Any]:
    """The data with what is in each policy's file in place of its name.

    Raises ConfigError for a file that is none, for what is wrong in it, and for any if code may
    not run.
    """
    given = data.get("policy")
    if isinstance(given, list | tuple):
        policies: Any = [
            _with_file(entry, ("policy", n), places, folder_of, may_run)
            for n, entry in enumerate(given)
        ]
    else:
        policies = _with_file(given, ("policy",), places, folder_of, may_run)
    return {**data, "policy": policies} if given is not None else dict(data)


def _with_file(
    entry: object,
    path: KeyPath,
    places: Mapping[KeyPath, Place],
    folder_of: Callable[[KeyPath], Path],
    may_run: bool,
) -> object:
    name = entry.get(FILE) if isinstance(entry, dict) else None
    if not isinstance(entry, dict) or not isinstance(name, str) or not is_line(name):
        return entry
    path = (*path, FILE)
    if not may_run:
        problem = f"value {shown(name)}: expected none: with --no-code no file is run"
        raise misplaced(path, problem, places)
    try:
        return {**entry, FILE: read_policy(name, folder_of(path))}
    except ConfigError as error:
        if error.where:
            raise
        raise misplaced(path, error.problem, places) from None
