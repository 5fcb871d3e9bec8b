"""Tables of rows as files: equal rows give equal bytes, and a file is there whole or not at all.

Also which files must not be opened at all.
"""

from __future__ import annotations

import csv
import errno
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pyarrow

Row = dict[str, Any]
"""A cell is an int, a float or a text; the empty text stands for what there isn't."""


def refuse_special(path: str | os.PathLike[str]) -> None:
    """Raise OSError if ``path`` is neither a file nor a folder; no such file is fine.

    A named pipe waits for a writer, and a device may never end.
    """
    if os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path):
        raise OSError(errno.EINVAL, "expected a regular file", os.fspath(path))


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """A name to write to; what is there afterwards takes the place of ``path`` in one step."""
    part = path.with_name(f"{path.name}.part")
    try:
        yield part
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def write_text(text: str, path: Path) -> None:
    """Write a text file."""
    with replaced(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")


def write_csv(rows: Iterable[Row], columns: Sequence[str], path: Path) -> None:
    """Write a CSV file; floats with all their digits, as Python's ``repr``."""
    with replaced(path) as part, open(part, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([row[name] for name in columns] for row in rows)


def read_csv(path: Path, columns: Sequence[str]) -> list[dict[str, str]]:
    """The rows of a CSV file, cells as they are written.

    Raises OSError, or ValueError if it lacks one of ``columns`` or a row has not all cells.
    """
    with open(path, encoding="utf-8", newline="") as file:
        reader = csv.reader(file, strict=True)
        header = next(reader, [])
        missing = [name for name in columns if name not in header]
        if missing or len(set(header)) < len(header):
            raise ValueError(f"{path.name} lacks the column {missing[0] if missing else 'names'}")
        rows = list(reader)
    for number, row in enumerate(rows, 2):
        if len(row) != len(header):
            raise ValueError(f"{path.name}:{number} has {len(row)} cells, not {len(header)}")
    return [dict(zip(header, row, strict=True)) for row in rows]


def write_parquet(rows: Sequence[Row], columns: Sequence[str], path: Path) -> None:
    """Write the same as Parquet: int64, float64 or text; what isn't there is null."""
    from pyarrow import parquet

    with replaced(path) as part:
        parquet.write_table(as_arrow(rows, columns), part)


def as_arrow(rows: Sequence[Row], columns: Sequence[str]) -> pyarrow.Table:
    """The table in memory; a column is text as soon as one of its cells is."""
    import pyarrow

    return pyarrow.table({name: _column([row[name] for row in rows]) for name in columns})


def _column(cells: list[Any]) -> pyarrow.Array:
    import pyarrow

    present = [None if cell == "" else cell for cell in cells]
    kinds = {type(cell) for cell in present if cell is not None}
    text = str in kinds or not kinds
    kind = pyarrow.string() if text else pyarrow.float64() if float in kinds else pyarrow.int64()
    convert: Callable[[Any], Any] = str if text else float if float in kinds else int
    return pyarrow.array([None if cell is None else convert(cell) for cell in present], kind)


def sort_key(row: Row, keys: Sequence[str]) -> list[tuple[bool, Any]]:
    """Numbers by size, before texts, and so before the empty text."""
    return [(isinstance(row[key], str), row[key]) for key in keys]
