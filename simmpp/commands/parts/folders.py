"""Folders as arguments: ``DIR``, or ``NAME=DIR`` for what several of them are to be called."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import click

from simmpp.commands.parts.options import NamedPath
from simmpp.common.errors import ConfigError
from simmpp.common.strict import is_line

NAMED = "[NAME=]DIR"


class GivenFolder(NamedTuple):
    """A folder as it was given."""

    name: str
    """Empty if none was."""
    path: Path


class FolderArgument(NamedPath):
    """A folder, with or without a name; one that is there is taken as it is, equals sign or not."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """A GivenFolder."""
        name, equals, path = str(value).partition("=")
        if not equals or Path(value).exists():
            return GivenFolder("", super().convert(value, param, ctx))
        if not is_line(name):
            self.fail(f"value {value!r}: expected a folder, or NAME=DIR", param, ctx)
        return GivenFolder(name, super().convert(path, param, ctx))


def by_name(given: Sequence[GivenFolder]) -> dict[str, Path]:
    """Folders by their names; one without is called by the end of its path if that tells it apart.

    Raises ConfigError if two are called the same.
    """
    ends = [one.name or one.path.resolve().name or str(one.path) for one in given]
    names = [
        one.name or (end if ends.count(end) == 1 else str(one.path))
        for one, end in zip(given, ends, strict=True)
    ]
    for name in names:
        if names.count(name) > 1:
            raise ConfigError(f"two folders are called {name!r}: expected NAME=DIR for each")
    return {name: one.path for name, one in zip(names, given, strict=True)}
