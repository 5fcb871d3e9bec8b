"""Files are there whole or not at all, and errors name them; equal rows give equal bytes.

Also which files must not be opened at all.
"""

from __future__ import annotations

import csv
import errno
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pyarrow

Row = dict[str, Any]
"""A cell is an int, a float or a text; the empty text stands for what there isn't."""
_numbers = count()


def refuse_special(path: str | os.PathLike[str]) -> None:
    """Raise OSError if ``path`` is neither a file nor a folder; no such file is fine.

    A named pipe waits for a writer, and a device may never end.
    """
    if os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path):
        raise OSError(errno.EINVAL, "expected a regular file", os.fspath(path))


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """A name to write to; what is there afterwards takes the place of ``path`` in one step.

    Whatever else is written at the same time has another name, and that isn't made of this one,
    which may be as long as names can be. A link stays, what it points to is replaced. What can't be
    written raises an OSError that names ``path``.
    """
    refuse_special(path)
    target = Path(os.path.realpath(path))
    part = target.with_name(f".simmpp-{os.getpid()}-{next(_numbers)}.part")
    try:
        with naming(path):
            yield part
            os.replace(part, target)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """An OSError in here is about this file: a full disk doesn't say what did not fit."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno or errno.EIO, error.strerror or str(error), str(path)) from error


def write_text(text: str, path: Path) -> None:
    """Write a text file; what UTF-8 has no bytes for (see :func:`in_utf8`) as a question mark."""
    with replaced(path) as part:
        part.write_text(text, encoding="utf-8", errors="replace", newline="\n")


def in_utf8(text: str) -> str:
    """The text with a question mark for each byte of a file's name that isn't UTF-8."""
    return text.encode("utf-8", "replace").decode("utf-8")


def copy(source: Path, path: Path) -> None:
    """Write what another file holds."""
    with replaced(path) as part:
        part.write_bytes(source.read_bytes())


def write_csv(rows: Iterable[Row], columns: Sequence[str], path: Path) -> None:
    """Write a CSV file; floats with all their digits, as Python's ``repr``."""
    with (
        replaced(path) as part,
        open(part, "w", encoding="utf-8", errors="replace", newline="") as file,
    ):
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

    with replaced(path) as part, open(part, "wb") as file:  # pyarrow opens names in UTF-8 only
        parquet.write_table(as_arrow(rows, columns), file)


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
    convert: Callable[[Any], Any] = _text if text else float if float in kinds else int
    return pyarrow.array([None if cell is None else convert(cell) for cell in present], kind)


def _text(cell: object) -> str:
    return in_utf8(str(cell))


def sort_key(row: Row, keys: Sequence[str]) -> list[tuple[bool, Any]]:
    """Numbers by size, before texts, and so before the empty text."""
    return [(isinstance(row[key], str), row[key]) for key in keys]
