"""Tables that fit: what is too wide for the terminal is arranged otherwise, and never cut.

A table that does not fit says its constant columns in a line above it; then the first columns above
each section of rows that have them in common, under names broken into lines; then it goes into
blocks of columns, below each other; and at last it shows row by row. Numbers stay whole.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Literal

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

GAP = 2
"""Blanks between columns."""
LEAST_PROSE = 24
"""Columns that sentences need at least, to be read beside others."""


_NUMBER = re.compile(r"[-+]?(\d|inf)|$")
"""How numbers begin, also with a unit; there may be none."""


@dataclass(frozen=True)
class Column:
    """A column of texts."""

    name: str
    cells: tuple[str, ...]
    is_number: bool = False
    """To the right, and never broken."""
    is_prose: bool = False
    """Sentences, which take the room that is left."""

    @property
    def least(self) -> int:
        """Characters that it needs."""
        widest = max(map(cell_len, (*self.name.split("\n"), *self.cells)), default=0)
        return min(widest, LEAST_PROSE) if self.is_prose else widest

    @property
    def is_constant(self) -> bool:
        """Every row has the same."""
        return len(set(self.cells)) == 1


@dataclass(frozen=True)
class Fitting:
    """A table that rich prints in the width that there is."""

    columns: tuple[Column, ...]
    n_keys: int
    """The first columns, which name a row."""
    is_sweep: bool = False
    """What all rows have in common goes above the table in any case."""

    @property
    def n_rows(self) -> int:
        """Rows without the names of columns."""
        return len(self.columns[0].cells) if self.columns else 0

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Called by rich."""
        keys, others = self.columns[: self.n_keys], self.columns[self.n_keys :]
        width = options.max_width
        if self.n_rows > 1 and (self.is_sweep or not _fit((*keys, *others), width)):
            constant = [column for column in self.columns if column.is_constant]
            if said := [column for column in constant if column.cells[0]]:
                yield _named(said, [column.cells[0] for column in said])
            keys, others = _varying(keys), _varying(others)
        if keys or others:
            yield from _arranged(keys, others, width)


def table(
    rows: Sequence[Mapping[str, object]], n_keys: int | None = None, *, is_sweep: bool = False
) -> Fitting:
    """Rows with the same keys as a table; numbers to the right.

    The first columns of texts name the rows, the first one at least, unless it is said how many do.
    """
    first = rows[0] if rows else {}
    if n_keys is None:
        n_keys = next((n for n, cell in enumerate(first.values()) if not isinstance(cell, str)), 1)
        n_keys = max(n_keys, 1)
    columns = []
    for number, name in enumerate(first):
        cells = tuple(_cell(row[name]) for row in rows)
        written = number >= n_keys and all(map(_NUMBER.match, cells))
        columns.append(Column(name, cells, written or not isinstance(first[name], str)))
    return Fitting(tuple(columns), n_keys, is_sweep)


def texts(names: Sequence[str], rows: Iterable[Sequence[str]], whole: int = 2) -> Fitting:
    """Rows of texts as a table; only columns after the first ``whole`` are broken into lines."""
    by_column = zip(*rows, strict=True)
    columns = tuple(
        Column(name, cells, is_prose=number >= whole)
        for number, (name, cells) in enumerate(zip(names, by_column, strict=False))
    )
    return Fitting(columns, 1)


def numbers(names: Sequence[str], rows: Iterable[tuple[str, Sequence[str]]]) -> Fitting:
    """Rows of numbers written out, after the name of each row."""
    labels, cells = zip(*rows, strict=True)
    columns = zip(names, zip(*cells, strict=True), strict=True)
    return Fitting(
        (Column("", labels), *(Column(name, column, is_number=True) for name, column in columns)), 1
    )


def _cell(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _varying(columns: Iterable[Column]) -> tuple[Column, ...]:
    return tuple(column for column in columns if not column.is_constant)


def _broken(columns: Iterable[Column]) -> tuple[Column, ...]:
    """With their names broken after blanks, dots and underscores."""
    return tuple(
        replace(column, name=re.sub(r"(?<=[_.]) ?(?=\w)| ", "\n", column.name))
        for column in columns
    )


def _fit(columns: Sequence[Column], width: int) -> bool:
    return sum(column.least + GAP for column in columns) - GAP <= width


def _arranged(keys: Sequence[Column], others: Sequence[Column], width: int) -> RenderResult:
    """As one table, in sections or blocks of one, or row by row."""
    if _fit((*keys, *others), width):
        yield _grid((*keys, *others))
        return
    narrow_keys, narrow = _broken(keys), _broken(others)
    if any(column.is_prose for column in others):
        yield from _records(keys, others)
    elif (said := _said_above(narrow_keys, narrow, width)) is not None:
        yield from _sections(keys[:said], (*narrow_keys[said:], *narrow))
    elif all(_fit((*narrow_keys, column), width) for column in narrow):
        yield from _blocks(narrow_keys, narrow, width)
    else:
        yield from _records(keys, others)


def _said_above(keys: Sequence[Column], others: Sequence[Column], width: int) -> int | None:
    """How many of the first keys must be said above the rows that have them; None if it is in vain.

    Sections of less than two rows are no tables.
    """
    for said in range(len(keys)):
        sections = len(list(_rows_by(keys[:said])))
        if 2 * sections > max(len(keys[0].cells), 2):
            return None
        if _fit((*keys[said:], *others), width):
            return said
    return None


def _rows_by(keys: Sequence[Column]) -> Iterator[tuple[tuple[str, ...], list[int]]]:
    """What the keys are, and the rows below each other where they are so."""
    rows = range(len(keys[0].cells)) if keys else ()
    for cells, equal in groupby(rows, lambda row: tuple(column.cells[row] for column in keys)):
        yield cells, list(equal)


def _sections(keys: Sequence[Column], others: Sequence[Column]) -> RenderResult:
    """A line of the keys, and below it the rows where they are so."""
    if not keys:
        yield _grid(others)
    for number, (cells, rows) in enumerate(_rows_by(keys)):
        if number:
            yield Text()
        yield _named(keys, cells)
        yield _grid(others, rows)


def _blocks(keys: Sequence[Column], others: Sequence[Column], width: int) -> RenderResult:
    """As many of the others at a time as fit beside the keys."""
    block = tuple(keys)
    for column in others:
        if not _fit((*block, column), width):
            yield _grid(block)
            yield Text()
            block = tuple(keys)
        block = (*block, column)
    yield _grid(block)


def _records(keys: Sequence[Column], others: Sequence[Column]) -> RenderResult:
    """Each row as a line of what names it, and below it a line for each of the others."""
    if len(keys) == 1 and keys[0].name:
        yield Text(keys[0].name, "bold")
    for row in range(len((*keys, *others)[0].cells)):
        if len(keys) == 1:
            yield Text(keys[0].cells[row])
        else:
            yield _named(keys, [column.cells[row] for column in keys])
        grid = _empty_grid(show_header=False)
        grid.add_column(no_wrap=True)
        grid.add_column()
        for column in others:
            if column.cells[row]:
                grid.add_row(Text(column.name), Text(column.cells[row]))
        yield Padding(grid, (0, 0, 0, GAP))


def _named(columns: Sequence[Column], cells: Sequence[str]) -> Text:
    """Names and what they are, in a line."""
    return Text(
        ", ".join(f"{c.name} {cell}".strip() for c, cell in zip(columns, cells, strict=True))
    )


def _grid(columns: Sequence[Column], rows: Sequence[int] | None = None) -> Table:
    """The rows of these numbers, or all; columns are as wide as all rows need."""
    grid = _empty_grid()
    for column in columns:
        justify: Literal["left", "right"] = "right" if column.is_number else "left"
        whole = not column.is_prose
        width = column.least if whole else None
        grid.add_column(column.name, justify=justify, no_wrap=whole, min_width=width)
    for row in range(len(columns[0].cells)) if rows is None else rows:
        grid.add_row(*(Text(column.cells[row]) for column in columns))
    return grid


def _empty_grid(*, show_header: bool = True) -> Table:
    return Table(box=None, pad_edge=False, padding=(0, GAP, 0, 0), show_header=show_header)
