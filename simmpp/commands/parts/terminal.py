"""Where commands print: tables on the output, progress and notices on the error output."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from simmpp.commands.parts.tables import Fitting

if TYPE_CHECKING:
    from simmpp.config.config import Config

WIDTH_OF_A_PIPE = 160
"""Columns where no terminal gives a width."""
OBJECTS_SHOWN = 20
"""Lines of a list of objects, unless all are asked for."""
FAILED = 1
"""Exit code of a command that worked, when what it ran failed, or is not what it should be."""
TRACER_S, ENGINE_S = 12, 28
"""What compiling takes on a core of 2020: ``tests/bench/bench_first_use.py`` measures it."""


class _Results(Console):
    """Rich would exit with 1 when the reader of a pipe has gone; simmpp.cli decides that."""

    def on_broken_pipe(self) -> None:
        """Raise it again."""
        raise BrokenPipeError


class _Errors(Console):
    """The console of progress."""

    @property
    def encoding(self) -> str:
        """ASCII where the user's language says no more, though Python writes UTF-8 there.

        LC_CTYPE says nothing: Python sets it (PEP 538).
        """
        language = os.environ.get("LC_ALL") or os.environ.get("LANG")
        return "ascii" if language in ("C", "POSIX") else super().encoding


def errors() -> Console:
    """The console of what is no result."""
    return _Errors(stderr=True)


def say(what: str | Fitting = "") -> None:
    """Print a result: a table, or lines, which are broken between words where they are too wide.

    In a pipe lines stay whole.
    """
    people = _is_terminal(sys.stdout)
    width = None if people else WIDTH_OF_A_PIPE
    console = _Results(width=width, highlight=False, markup=False, emoji=False)
    console.print(what, soft_wrap=isinstance(what, str) and not people)


def _is_terminal(stream: TextIO | None) -> bool:
    """Whether people read it; Python has None for a stream that was closed before it began."""
    return stream is not None and stream.isatty()


def notice(text: str) -> None:
    """One line for the user that isn't a result."""
    click.echo(f"simmpp: {text}", err=True)


def warn(config: Config, *, is_swept: bool) -> None:
    """Say what a configuration has that does not do what it seems to."""
    from simmpp.config.misleading import misleading

    for line in misleading(config, is_swept=is_swept):
        notice(f"warning: {line}")


def wrote(*paths: Path) -> None:
    """Say which files there are now."""
    if paths:
        say(f"wrote {', '.join(map(str, paths))}")


def go_on(*command: str | Path) -> None:
    """Say how to go on with what was written: words of a call of simmpp."""
    click.echo(f"next: {shlex.join(['simmpp', *map(str, command)])}")


def announce_compilation(*, simulating: bool = True) -> None:
    """Say why nothing seems to happen when tracer and engine are used for the first time.

    If both are, and there is a core for each, the engine is compiled by a process beside this one
    until the command ends.
    """
    from simmpp.commands.parts.options import available_cores
    from simmpp.common.cache import cache_folder
    from simmpp.common.code.kept import is_compiled, keeps_code
    from simmpp.common.modules import CANDIDATES, ENGINE
    from simmpp.sweeps.compile_engine import engine_compiled_beside

    times_s = {CANDIDATES: TRACER_S, ENGINE: ENGINE_S if simulating else 0}
    missing_s = [time_s for module, time_s in times_s.items() if time_s and not is_compiled(module)]
    if not missing_s:
        return
    beside = len(missing_s) > 1 and available_cores() > 1 and keeps_code()
    often = "once" if keeps_code() else f"each time, as {cache_folder()} can't be written"
    wait_s = max(missing_s) if beside else sum(missing_s)
    notice(f"compiling for this machine, {often}: about {wait_s} s")
    if beside:
        click.get_current_context().with_resource(engine_compiled_beside())


@contextmanager
def progress_bars() -> Iterator[Progress]:
    """Bars on the error output; none when that isn't a terminal."""
    bars = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeRemainingColumn(),
        console=errors(),
        transient=True,
        disable=not _is_terminal(sys.stderr),
    )
    with bars:
        yield bars


@contextmanager
def at_work(what: str) -> Iterator[None]:
    """A bar that moves, for what takes seconds but can't say how far it is."""
    with progress_bars() as bars:
        bars.add_task(what, total=None)
        yield
