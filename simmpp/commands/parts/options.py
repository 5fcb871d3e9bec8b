"""Options that several commands have, and the checks of values that click would let through."""

from __future__ import annotations

import math
import os
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from simmpp.common.errors import ConfigError
from simmpp.common.folders import claimed, held
from simmpp.common.units import picoseconds

ENGINES = ("compiled", "simpy")
"""Names of :data:`simmpp.engine.simulate.ENGINES`, which would import numba: sweep must not yet."""
LAST_PS = (1 << 63) - 1
"""Later than any run ends."""


class Whole(click.IntRange):
    """An integer between bounds."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """The integer."""
        try:
            return int(super().convert(value, param, ctx))
        except click.BadParameter:
            expected = f"expected an integer from {self.min} to {self.max}"
            self.fail(f"value {value!r}: {expected}", param, ctx)


class Real(click.FloatRange):
    """A number between bounds; NaN, which is within any, is refused, and so is infinity."""

    def __init__(self, expected: str, low: float, high: float | None = None, **ends: bool) -> None:
        super().__init__(low, high, **ends)
        self._expected = expected

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """The number."""
        try:
            number = float(super().convert(value, param, ctx))
        except click.BadParameter:
            number = math.nan
        if not math.isfinite(number):
            self.fail(f"value {value!r}: expected {self._expected}", param, ctx)
        return number


class NamedPath(click.Path):
    """A path; the empty text, which pathlib takes for the current folder, is refused."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path."""
        if value == "":
            self.fail("value '': expected the name of a file or folder", param, ctx)
        return super().convert(value, param, ctx)


class Word(click.Choice[str]):
    """One of a few words; a mistake is told as in a configuration."""

    def get_invalid_choice_message(self, value: Any, ctx: click.Context | None) -> str:
        """What was given and what was expected."""
        return f"value {value!r}: expected {' or '.join(self.choices)}"


config_argument = click.argument("config_path", metavar="CONFIG", type=NamedPath())
"""``CONFIG``, which the command gets as ``config_path``."""


def path(name: str, help_text: str, **settings: Any) -> Callable[[Any], Any]:
    """An option that takes a path; ``settings`` are those of click."""
    return click.option(name, type=NamedPath(), help=help_text, **settings)


def setting(help_text: str) -> Callable[[Any], Any]:
    """``--set KEY=VALUE``, which the command gets as ``overrides``."""
    return click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help=help_text)


def engine(help_text: str) -> Callable[[Any], Any]:
    """``--engine NAME``, which the command gets as ``engine``, overrides to add to those of set."""
    return click.option(
        "--engine",
        type=Word(ENGINES),
        callback=lambda ctx, param, name: () if name is None else (f"engine={name}",),
        help=help_text,
    )


def workers(help_text: str) -> Callable[[Any], Any]:
    """``--workers N``, which the command gets as ``workers``; see :func:`available_cores`."""
    return click.option("--workers", type=Whole(1, 4096), help=help_text)


no_code = click.option(
    "--no-code",
    "may_run",
    flag_value=False,
    default=True,
    help="Refuse policies that are files: such a file is code, which is run.",
)
"""``--no-code``, which the command gets as ``may_run``."""


def call() -> str:
    """The words by which simmpp was called, as a shell takes them."""
    return shlex.join(click.get_current_context().obj or ())


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def examples(*lines: str) -> str:
    """The end of a command's help: calls to begin with, a line each."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def writable(path: Path | None, option: str, suffix: str = "") -> None:
    """Raise ConfigError unless a file so called can be written at ``path``; None is fine.

    Commands ask before hours of work, not after.
    """
    if path is None:
        return
    if not path.name.lower().endswith(suffix):
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file {suffix}")
    if path.is_dir():
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file, it is a folder")
    if not path.parent.is_dir():
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file in an existing folder")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise ConfigError(f"{option}: value {str(path)!r}: expected a file that can be written")


def folder(path: Path | None, option: str) -> None:
    """Make the folder at ``path``; ConfigError if that can't be; None is fine."""
    if path is None:
        return
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise ConfigError(f"{option}: value {str(path)!r}: can't make it: {reason}") from None
    if not os.access(path, os.W_OK):
        raise ConfigError(f"{option}: value {str(path)!r}: expected a folder that can be written")


def claim(path: Path | None, option: str, kind: str | None = None) -> None:
    """Make the folder and hold it until the command ends; see :mod:`simmpp.common.folders`.

    Commands whose work does so itself, as for those who call it from Python, ask for a ``folder``.
    """
    folder(path, option)
    if path is not None:
        holding = held(path) if kind is None else claimed(path, kind)
        click.get_current_context().with_resource(holding)


def window_of(text: str, option: str) -> tuple[int, int]:
    """``START:END``, two times with units, in picoseconds.

    Without START it begins at 0, without END it has no end. Raises ConfigError for anything else.
    """
    start, colon, end = text.partition(":")
    try:
        start_ps = picoseconds(start, LAST_PS) if start.strip() else 0
        end_ps = picoseconds(end, LAST_PS) if end.strip() else LAST_PS
    except ConfigError as error:
        raise ConfigError(f"{option}: {error}") from None
    if not colon or start_ps >= end_ps:
        problem = "expected START:END such as '0 ms:5 ms', START before END"
        raise ConfigError(f"{option}: value {text!r}: {problem}")
    return start_ps, end_ps
