"""What there is in a folder: rows of a sweep, a run, a bench, or the paper's experiments."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row, read_csv
from simmpp.common.folders import is_at_work, last_call
from simmpp.methods.columns import COLUMNS, FURTHER, KEYS, METHOD, NUMBERS, TEXTS
from simmpp.run import words
from simmpp.run.record import read_record
from simmpp.run.rows import (
    PROFITS,
    RECORD,
    RESULTS,
    TIMINGS,
    has_ended,
    in_order,
    is_unfit,
)
from simmpp.studies.bench.bench import BENCH
from simmpp.studies.bench.errors import bench_columns
from simmpp.studies.nebel98.reproduce import CLAIMS, EXPERIMENTS
from simmpp.studies.nebel98.verdict import CLAIM_COLUMNS
from simmpp.sweeps.intervals import PLAIN
from simmpp.sweeps.journal import FILE as JOURNAL
from simmpp.sweeps.profits import profit_columns
from simmpp.sweeps.stopping import CORRECTED

INTEGERS = {"processors", "seed", *NUMBERS, *FURTHER} - {*TEXTS}
NUMERIC = {"fraction", "effective_fraction"}
MAY_BE_EMPTY = {"fraction", "effective_fraction", *NUMBERS, *FURTHER}
"""A memory given in bytes has no fraction, a failed point no results, and a method does not know
all of them."""


@dataclass(frozen=True)
class Folder:
    """Rows and what lies beside them."""

    path: Path
    rows: list[Row]
    further: tuple[str, ...] = ()
    """Columns of keys beyond those that all rows have, and the method where it changes."""
    experiments: Mapping[str, list[Row]] = field(default_factory=dict)
    """Rows of the paper's experiments by name; ``rows`` has all of them, each once."""
    claims: Sequence[Mapping[str, str]] = ()
    timings: Sequence[Mapping[str, str]] = ()
    profits: Sequence[Row] = ()
    """Those of ``profits.csv``, if there is one."""
    bench: Sequence[Row] = ()
    """Those of ``bench.csv``."""
    record: Mapping[str, Any] = field(default_factory=dict)
    """``run.json``."""
    parts: Mapping[str, Folder] = field(default_factory=dict)
    """By name, the folders that these are the rows of, where there are several."""
    called: str = ""
    """By its user, if at all."""

    @property
    def title(self) -> str:
        """What it, or they, are called."""
        joint = words.any_of(self.parts, "and") if self.parts else ""
        return self.called or joint or self.path.resolve().name

    @property
    def seeds(self) -> int:
        """How many different ones there are."""
        return len({row["seed"] for row in self.rows})

    @property
    def planned(self) -> int:
        """Rows that there will be; as many as there are, where nothing says how many."""
        points = self.record.get("points")
        return points if isinstance(points, int) else len(self.rows)

    @property
    def labels(self) -> dict[str, str]:
        """The policy of each label, as far as the record's configuration tells."""
        return dict(_labelled(self.record.get("config")))

    @property
    def confidence(self) -> float:
        """Of the quantiles of its intervals: seeds that a tolerance chose need wider ones."""
        if self.parts:
            return max(part.confidence for part in self.parts.values())
        config = self.record.get("config")
        has_tolerance = isinstance(config, dict) and config.get("tolerance") is not None
        return CORRECTED if has_tolerance else PLAIN

    @property
    def failed(self) -> list[Row]:
        """Rows with an error in place of results."""
        return [row for row in self.rows if row["error"]]


def read_folder(path: Path, name: str = "DIR") -> Folder:
    """Read a folder; ``name`` is the argument it was given as.

    Raises ConfigError, one line, if there are no rows or a file is damaged.
    """
    if not path.is_dir():
        raise ConfigError(f"{name}: value {str(path)!r}: expected a folder")
    claims = _table(path / CLAIMS, CLAIM_COLUMNS)
    timings = _table(path / TIMINGS, ("policy", "trace_s", "wall_s"))
    with undamaged(path / RECORD):
        record = read_record(path / RECORD) if (path / RECORD).is_file() else {}
    bench = numbers_of(_table(path / BENCH, bench_columns(())))
    if (path / RESULTS).is_file():
        rows, further = read_rows(path / RESULTS)
        table = _table(path / PROFITS, profit_columns())
        profits = [_typed(row, path / PROFITS, line) for line, row in enumerate(table, 2)]
        return Folder(path, rows, further, {}, claims, timings, profits, bench, record)
    files = {name: path / f"{name}.csv" for name in EXPERIMENTS}
    experiments = {name: read_rows(file)[0] for name, file in files.items() if file.is_file()}
    if not experiments and not bench:
        raise ConfigError(f"{name}: value {str(path)!r}: {_no_rows(path)}")
    return Folder(path, _once(experiments), (), experiments, claims, timings, (), bench, record)


def _no_rows(path: Path) -> str:
    """Why there are none."""
    if is_at_work(path):
        return "there are no rows yet: the command that works here writes them at its end"
    if (path / JOURNAL).is_file():
        call = last_call(path) or "the call that began it"
        return f"interrupted, before there were rows; to go on: {call}"
    return (
        f"there are no rows: expected {RESULTS} (of run or sweep), {EXPERIMENTS[0]}.csv (of "
        f"reproduce) or {BENCH} (of bench)"
    )


def _labelled(node: object) -> Iterator[tuple[str, str]]:
    """Label and name of each policy in a configuration, those of its sweep included."""
    if isinstance(node, Mapping):
        label, name = node.get("label"), node.get("name")
        if isinstance(label, str) and isinstance(name, str):
            yield label, name
        node = list(node.values())
    if isinstance(node, list):
        for child in node:
            yield from _labelled(child)


def _once(experiments: Mapping[str, list[Row]]) -> list[Row]:
    """All rows; a point that several experiments have is there once."""
    rows = {tuple(row[key] for key in KEYS): row for of in experiments.values() for row in of}
    return in_order(rows.values())


def read_rows(path: Path) -> tuple[list[Row], tuple[str, ...]]:
    """The rows of a ``results.csv`` with numbers as such, and the columns of further keys."""
    texts = _table(path, COLUMNS)
    further = further_of(texts)
    rows = [_typed(row, path, line) for line, row in enumerate(texts, 2)]
    for line, row in enumerate(rows, 2):
        if not (row["error"] or has_ended(row) or is_unfit(row)):
            raise ConfigError("expected results or an error", where=str(path), line=line)
    return rows, further


def further_of(rows: Sequence[Row]) -> tuple[str, ...]:
    """The columns of further keys, and the method where it changes."""
    names = rows[0] if rows else ()
    further = tuple(name for name in names if name not in (*COLUMNS, *FURTHER))
    return (*further, METHOD) if len({row[METHOD] for row in rows}) > 1 else further


def _table(path: Path, columns: Sequence[str]) -> list[dict[str, str]]:
    """A CSV file's rows; none if there is no such file."""
    with undamaged(path):
        return read_csv(path, columns) if path.is_file() else []


@contextmanager
def undamaged(path: Path) -> Iterator[None]:
    """Say where what can't be read is."""
    try:
        yield
    except (ValueError, csv.Error) as error:
        raise ConfigError(f"damaged: {error}", where=str(path)) from None


def numbers_of(rows: Sequence[Mapping[str, str]]) -> list[Row]:
    """Rows of a CSV file, with numbers where cells look like some."""
    return [{name: number_of(cell) for name, cell in row.items()} for row in rows]


def _typed(row: Mapping[str, str], path: Path, line: int) -> Row:
    """Numbers where numbers belong, and in further keys where they look like some."""
    typed: Row = {}
    for name, cell in row.items():
        try:
            typed[name] = _cell(name, cell)
        except ValueError:
            expected = "an integer" if name in INTEGERS else "a number"
            raise ConfigError(
                f"column {name}: value {cell!r}: expected {expected}", where=str(path), line=line
            ) from None
    return typed


def _cell(name: str, text: str) -> int | float | str:
    if name in MAY_BE_EMPTY and text == "":
        return ""
    if name in INTEGERS:
        return int(text)
    if name in NUMERIC:
        return _finite(text)
    return text if name in (*COLUMNS, *TEXTS) else number_of(text)


def number_of(text: str) -> int | float | str:
    """The number that a cell looks like, or its text."""
    with suppress(ValueError):
        return int(text)
    with suppress(ValueError):
        return _finite(text)
    return text


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(text)
    return number
