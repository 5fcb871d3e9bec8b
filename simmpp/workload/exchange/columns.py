"""A table of rays or of objects as another program wrote it: columns that are checked when read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import WorkloadError
from simmpp.scene.nff_words import LARGEST

WORKLOAD_SUFFIXES = (".parquet", ".npz")
RAY_COLUMNS = (
    *("itinerary", "parent", "kind", "pixel", "hit", "distance"),
    *("round", "home", "weight", "test_scale", "deposit"),
)
OBJECT_COLUMNS = ("bytes", "kind", "triangles", "test_ps", "results", "x", "y", "z")
ITINERARY = ("itinerary_offsets", "itinerary_objects")
"""The two columns of rays that hold one itinerary per row, as CSR."""
DEPOSITS = "itinerary_deposits"
"""A number for each entry of the itineraries."""
DEPOSIT_OFFSETS = "deposit_offsets"
"""Where these are lists of their own in the file: their offsets, which have to be the same."""
Column = NDArray[Any]
MOST_ROWS = 2**31 - 2
"""Rays, and objects, are numbered by int32; offsets have one more entry."""
LONGEST_WORD = 20
"""Characters kept of a word: enough to tell it in an error."""


def is_workload(name: str) -> bool:
    """Whether a file's name says that it holds the rays of a workload."""
    return name.lower().endswith(WORKLOAD_SUFFIXES)


@dataclass(frozen=True, eq=False)
class CheckedTable:
    """Columns by name, all of ``rows`` entries; whatever is wrong with one raises WorkloadError."""

    where: str
    """The file, for errors."""
    prefix: str
    """What the names of this table's columns begin with in the file."""
    rows: int
    columns: dict[str, Column]

    def fail(self, column: str, problem: str, row: int | None = None) -> NoReturn:
        """Raise WorkloadError: file, column, row, and the problem."""
        place = f"column {self.prefix}{column}" + ("" if row is None else f", row {row}")
        raise WorkloadError(f"{place}: {problem}", where=self.where)

    def require(self, good: NDArray[np.bool_], column: str, expected: str) -> None:
        """Fail at the first row that isn't good, with the value there."""
        if not good.all():
            row = int(np.argmin(good))
            value = _shown(self.columns[column][row])
            self.fail(column, f"value {value}: expected {expected}", row)

    def known(self, names: Sequence[str], required: Sequence[str] = ()) -> None:
        """Fail for a column that has no meaning, and for one that is missing."""
        for name in self.columns:
            if name not in names:
                near = get_close_matches(name.lower(), names, n=1)
                hint = f"did you mean {self.prefix}{near[0]}?" if near else ""
                expected = f"expected one of {', '.join(self.prefix + n for n in names)}"
                self.fail(name, f"it is unknown: {hint or expected}")
        for name in required:
            if name not in self.columns:
                self.fail(name, "it is missing")

    def integers(
        self, name: str, least: int, most: int, default: int, expected: str = ""
    ) -> NDArray[np.int64]:
        """(rows,) int64, each from ``least`` to ``most``; the default where there is no column."""
        if name not in self.columns:
            return np.full(self.rows, default, np.int64)
        column = self.columns[name]
        if column.dtype.kind not in "iu":
            self.fail(name, f"it holds {_what(column)}, expected integers")
        within = (column >= least) & (column <= most)
        self.require(within, name, expected or f"an integer from {least} to {most}")
        return column.astype(np.int64)

    def numbers(self, name: str, where: NDArray[np.bool_] | bool = True) -> NDArray[np.float64]:
        """(rows,) float64, of a size that can be reckoned with ``where`` that is asked; 0 where
        there is no column."""
        if name not in self.columns:
            return np.zeros(self.rows)
        column = self.columns[name]
        if column.dtype.kind not in "iuf":
            self.fail(name, f"it holds {_what(column)}, expected numbers")
        with np.errstate(over="ignore"):
            column = column.astype(np.float64)
        bounded = np.abs(column) <= LARGEST  # NaN is not
        expected = f"a finite number of at most {LARGEST:g}"
        self.require(bounded | ~np.asarray(where), name, expected)
        return column

    def choices(self, name: str, words: Sequence[str], default: Column) -> NDArray[np.uint8]:
        """(rows,) uint8: indices into ``words``; the column holds these or the words."""
        if name not in self.columns:
            return default.astype(np.uint8)
        column = self.columns[name]
        choices = ", ".join(f"{word} ({index})" for index, word in enumerate(words))
        if column.dtype.kind == "U":
            is_word = column[:, None] == np.array(words)
            self.require(is_word.any(axis=1), name, f"one of {choices}")
            indices = is_word.argmax(axis=1)
        else:
            indices = self.integers(name, 0, len(words) - 1, 0, f"one of {choices}")
        return indices.astype(np.uint8)


def _shown(value: Any) -> str:
    return repr(str(value)[:LONGEST_WORD]) if isinstance(value, str) else str(value)


def _what(column: Column) -> str:
    return "text" if column.dtype.kind == "U" else str(column.dtype)


@dataclass(frozen=True, eq=False)
class Content:
    """What a file holds; itineraries are two columns of rays: offsets (rows + 1) and objects; with
    deposits three."""

    rays: CheckedTable
    objects: CheckedTable
    picture: Column | None
    """Rows and columns of primary rays, and how many each pixel has, if the file says."""
