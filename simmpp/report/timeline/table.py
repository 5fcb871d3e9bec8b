"""Timelines as Parquet: one row per slice of a PE's time, and per arrival of a message."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import parquet

from simmpp.engine.arrays.records import NONE
from simmpp.machine.messages import MESSAGE_KINDS
from simmpp.report.timeline.slices import SLICE_KINDS, Rows, TimelinePart

_WORD = pa.dictionary(pa.int8(), pa.string())
SCHEMA = pa.schema(
    [
        ("policy", _WORD),
        ("event", _WORD),  # arrival, receive, compute, send, serve, answer, idle or probe
        ("pe", pa.int32()),
        ("begin_ps", pa.int64()),
        ("end_ps", pa.int64()),  # of a send: when the message departs
        ("kind", _WORD),  # of the message, and what follows
        ("other", pa.int32()),  # the PE at its other end
        ("number", pa.int64()),  # the sender's send number; none if it never departed
        ("payload_bytes", pa.int64()),
        ("rays", pa.int32()),  # in the message; finished by a compute
        ("objects", pa.int32()),  # in the message
        ("requests", pa.int32()),  # in the message
        ("tests", pa.int64()),
        ("load", pa.int32()),  # of the PE at the end
        ("ready", pa.int32()),
        ("waiting", pa.int32()),
    ]
)
"""Columns; times are integer picoseconds, what there is none of is null."""


class TimelineTable:
    """A Parquet file that grows part by part."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb")
        self._writer = parquet.ParquetWriter(self._file, SCHEMA, compression="zstd")
        self._policies: list[str] = []

    def begin(self, title: str, processors: int, server: str = "") -> None:
        """What is written from now on is the run of this policy."""
        self._policies.append(title)

    def add(self, part: TimelinePart) -> None:
        """Write a part of the timeline."""
        for rows in (part.slices, part.arrivals):
            if len(rows):
                self._writer.write_table(self._table(rows))

    def close(self) -> None:
        """End the file, which Parquet needs to be readable."""
        self._writer.close()
        self._file.close()

    def _table(self, rows: Rows) -> pa.Table:
        no_load = rows["load"] == NONE
        columns = {
            "policy": _words(np.full(len(rows), len(self._policies) - 1), self._policies),
            "event": _words(rows["event"], SLICE_KINDS),
            "begin_ps": pa.array(rows["time_ps"]),
            "kind": _words(rows["kind"], MESSAGE_KINDS),
            "ready": pa.array(rows["ready"], mask=no_load),
            "waiting": pa.array(rows["load"] - rows["ready"], mask=no_load),
        }
        for name in ("other", "number", "load"):
            columns[name] = pa.array(rows[name], mask=rows[name] == NONE)
        columns |= {n: pa.array(rows[n]) for n in SCHEMA.names if n not in columns}
        return pa.table([columns[name] for name in SCHEMA.names], schema=SCHEMA)


def _words(codes: NDArray[Any], names: list[str] | tuple[str, ...]) -> pa.Array:
    """Codes as words; negative ones are null."""
    indices = pa.array(codes.astype(np.int8), mask=codes < 0)
    return pa.DictionaryArray.from_arrays(indices, pa.array(list(names)))
