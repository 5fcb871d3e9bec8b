"""Types of the commands' options that refuse what click's own let through."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import click

from simmpp.errors import ConfigError


class FiniteRange(click.FloatRange):
    """A number between bounds; NaN, which is within any, is refused, and so is infinity."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number."""
        number: float = click.FLOAT.convert(value, param, ctx)
        if not math.isfinite(number):
            raise ConfigError(f"{_named(param)}: value {value!r}: expected a finite number")
        return float(super().convert(value, param, ctx))


class NamedPath(click.Path):
    """A path; the empty text, which pathlib takes for the current folder, is refused."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(
        self,
        value: Any,
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> Any:
        """The path."""
        if value == "":
            raise ConfigError(f"{_named(param)}: value '': expected the name of a file or folder")
        return super().convert(value, param, ctx)


def _named(param: click.Parameter | None) -> str:
    """The option or argument as the user knows it."""
    if isinstance(param, click.Option):
        return param.opts[0]
    return param.make_metavar(click.get_current_context()) if param else "argument"
