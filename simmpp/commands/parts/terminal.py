"""Where commands print: tables on the output, progress and notices on the error output."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TextIO

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

WIDTH_OF_A_PIPE = 160
"""Columns where no terminal gives a width."""
OBJECTS_SHOWN = 20
"""Lines of a list of objects, unless all are asked for."""
FAILED = 1
"""Exit code of a command that worked, when what it ran failed, or is not what it should be."""
TRACER_S, ENGINE_S = 10, 20
"""What compiling takes on a core of 2020: ``tests/bench/bench_first_use.py`` measures it."""


class _Results(Console):
    """Rich would exit with 1 when the reader of a pipe has gone; simmpp.cli decides that."""

    def on_broken_pipe(self) -> None:
        """Raise it again."""
        raise BrokenPipeError


def output() -> Console:
    """The console of results: plain text, as wide as the terminal."""
    width = None if _is_terminal(sys.stdout) else WIDTH_OF_A_PIPE
    return _Results(width=width, highlight=False, markup=False, emoji=False)


def _is_terminal(stream: TextIO | None) -> bool:
    """Whether people read it; Python has None for a stream that was closed before it began."""
    return stream is not None and stream.isatty()


def table(rows: Sequence[Mapping[str, object]]) -> Table:
    """Rows with the same keys as a table; numbers to the right."""
    grid = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name, value in (rows[0] if rows else {}).items():
        grid.add_column(name, justify="left" if isinstance(value, str) else "right", no_wrap=True)
    for row in rows:
        grid.add_row(*(f"{v:g}" if isinstance(v, float) else str(v) for v in row.values()))
    return grid


def texts(names: Sequence[str], rows: Iterable[Sequence[str]], whole: int = 2) -> Table:
    """Rows of texts as a table; only columns after the first ``whole`` are broken into lines."""
    grid = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for number, name in enumerate(names):
        grid.add_column(name, no_wrap=number < whole)
    for row in rows:
        grid.add_row(*row)
    return grid


def notice(text: str) -> None:
    """One line for the user that isn't a result."""
    click.echo(f"simmpp: {text}", err=True)


def announce_compilation(*, simulating: bool = True) -> None:
    """Say why nothing seems to happen when tracer and engine are used for the first time.

    If both are, and there is a core for each, the engine is compiled by a process beside this one
    until the command ends.
    """
    from simmpp.commands.parts.options import available_cores
    from simmpp.common.compiled import cache_folder, is_compiled, keeps_code
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
        console=Console(stderr=True),
        transient=True,
        disable=not _is_terminal(sys.stderr),
    )
    with bars:
        yield bars
