"""Where commands print: tables on the output, progress and notices on the error output."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

WIDTH_OF_A_PIPE = 160
"""Columns where no terminal gives a width."""


def output() -> Console:
    """The console of results: plain text, as wide as the terminal."""
    width = None if sys.stdout.isatty() else WIDTH_OF_A_PIPE
    return Console(width=width, highlight=False, markup=False, emoji=False)


def notice(text: str) -> None:
    """One line for the user that isn't a result."""
    click.echo(f"simmpp: {text}", err=True)


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
        disable=not sys.stderr.isatty(),
    )
    with bars:
        yield bars
