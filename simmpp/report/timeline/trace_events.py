"""Timelines as Trace Event JSON, which Perfetto (https://ui.perfetto.dev) and Chrome open.

A policy is a process, a PE a thread, and so is what serves beside it, if anything does. Format:
"Trace Event Format" of the Catapult project. Its times are microseconds; six decimals make them
exact picoseconds. Slices are pairs of begin and end, not events with a duration: Perfetto rounds
each number to nanoseconds, and would drop a slice whose rounded begin and duration reach into the
next one.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from simmpp.engine.arrays.records import COMPUTE, NONE
from simmpp.machine.messages import MESSAGE_KINDS
from simmpp.report.timeline.slices import (
    COMMUNICATION,
    IDLE,
    OF_SERVERS,
    SLICE_KINDS,
    Rows,
    TimelinePart,
    Times,
    is_of_server,
)

PS_PER_US = 10**6
_NAMES = [f"{event} {kind}".rstrip() for event in SLICE_KINDS for kind in (*MESSAGE_KINDS, "")]
_N = len(MESSAGE_KINDS) + 1
_CATEGORY = {COMPUTE: "compute", IDLE: "idle"} | dict.fromkeys(COMMUNICATION, "communication")
_CATEGORY |= dict.fromkeys(OF_SERVERS, "service")
_CATEGORIES = [_CATEGORY.get(event, "") for event in range(len(SLICE_KINDS))]
_COMPRESSION = 3

Texts = Any
"""A pyarrow array of texts, or one text for all rows."""


class TraceEvents:
    """A file of trace events, written as they come."""

    def __init__(self, path: Path, *, is_zipped: bool) -> None:
        self._file = path.open("wb")
        self._zipped: gzip.GzipFile | None = None
        if is_zipped:  # without a date: equal runs give equal bytes
            self._zipped = gzip.GzipFile("", "wb", _COMPRESSION, self._file, mtime=0)
        self._process = 0
        self._processors = 0
        self._arrows = 0
        self._is_empty = True
        self._write(b'{"displayTimeUnit":"ns","traceEvents":[')

    def begin(self, title: str, processors: int, server: str = "") -> None:
        """What is written from now on is the run of this policy."""
        self._process += 1
        self._processors = processors
        self._name("process_name", 0, title)
        for pe in range(processors):
            self._name("thread_name", pe, f"PE {pe}")
            if server:
                self._name("thread_name", processors + pe, f"{server} of PE {pe}")

    def _name(self, what: str, pe: int, name: str) -> None:
        event = {"ph": "M", "pid": self._process, "tid": pe + 1, "name": what}
        self._append(f",\n{json.dumps(event | {'args': {'name': name}})}".encode())

    def add(self, part: TimelinePart) -> None:
        """Write a part of the timeline."""
        slices, loads, arrows = part.slices, part.loads, part.arrows
        self._events(len(slices), self._slices(slices))
        self._events(len(arrows), self._arrows_of(part))
        self._events(len(loads), self._loads(loads))
        self._events(len(part.flights_ps), self._flights(part.flights_ps, part.in_flight))

    def close(self) -> None:
        """End the file; it is complete whenever that happens."""
        self._write(b"\n]}\n")
        if self._zipped is not None:
            self._zipped.close()
        self._file.close()

    def _slices(self, rows: Rows) -> list[Texts]:
        """Begin and end of each; a PE's come one after the other, as ties need."""
        track = [f'"pid":{self._process},"tid":', self._track(rows["pe"], is_of_server(rows))]
        track.append(',"ts":')
        return [
            '{"ph":"B",', *track, _us(rows["time_ps"]),
            # Kind NONE, -1, is the last modulo all: the name without a kind, behind those with one.
            ',"name":"', pa.array(_NAMES).take(rows["event"] * _N + rows["kind"] % _N),
            '","cat":"', pa.array(_CATEGORIES).take(rows["event"]),
            '"', _arguments(rows), '},\n{"ph":"E",', *track, _us(rows["end_ps"]), "}",
        ]  # fmt: skip

    def _track(self, pes: NDArray[np.integer], served: NDArray[np.bool_]) -> Texts:
        """The number of a PE's thread in the file, or of what serves beside the PE."""
        return _whole(pes + 1 + self._processors * served)

    def _arrows_of(self, part: TimelinePart) -> list[Texts]:
        """From the packing of a message, at whose end it departs, to its receipt."""
        rows, tails_ps = part.arrows, part.tails_ps
        numbers = _whole(self._arrows + np.arange(len(rows)))
        self._arrows += len(rows)
        common = [
            f'"pid":{self._process},"cat":"message","name":"',
            pa.array(MESSAGE_KINDS).take(rows["kind"]),
            '","id":', numbers, ',"tid":',
        ]  # fmt: skip
        return [
            '{"ph":"s",', *common, self._track(rows["other"], part.tails_served),
            ',"ts":', _us(tails_ps),
            '},\n{"ph":"f","bp":"e",', *common, self._track(rows["pe"], is_of_server(rows)),
            ',"ts":', _us(rows["time_ps"]), "}",
        ]  # fmt: skip

    def _loads(self, rows: Rows) -> list[Texts]:
        return [
            f'{{"ph":"C","pid":{self._process},"name":"PE ', _whole(rows["pe"]),
            '","ts":', _us(rows["end_ps"]), ',"args":{"load":', _whole(rows["load"]),
            ',"ready":', _whole(rows["ready"]),
            ',"waiting":', _whole(rows["load"] - rows["ready"]), "}}",
        ]  # fmt: skip

    def _flights(self, times_ps: Times, in_flight: Times) -> list[Texts]:
        return [
            f'{{"ph":"C","pid":{self._process},"name":"messages in flight","ts":',
            _us(times_ps), ',"args":{"messages":', _whole(in_flight), "}}",
        ]  # fmt: skip

    def _events(self, n: int, texts: Sequence[Texts]) -> None:
        """Write n events, whose pieces of text are ``texts``."""
        if n:
            lines = pc.binary_join_element_wise(",\n", *texts, "")
            _, ends, characters = lines.buffers()
            n_bytes = int(np.frombuffer(ends, np.int32)[n])
            self._append(memoryview(characters)[:n_bytes])

    def _append(self, events: bytes | memoryview) -> None:
        """Events, each after a comma, which the first of all has not."""
        self._write(events[1:] if self._is_empty else events)
        self._is_empty = False

    def _write(self, text: bytes | memoryview) -> None:
        (self._zipped or self._file).write(text)


def _arguments(rows: Rows) -> Texts:
    """What is told of a slice that is selected."""
    rays = _whole(rows["rays"])
    compute = pc.binary_join_element_wise(
        ',"args":{"tests":', _whole(rows["tests"]), ',"rays finished":', rays, "}", ""
    )  # fmt: skip
    message = pc.binary_join_element_wise(
        ',"args":{"other PE":', _whole(rows["other"]), ',"number":', _whole(rows["number"]),
        ',"rays":', rays, ',"bytes":', _whole(rows["payload_bytes"]), "}", "",
    )  # fmt: skip
    about = pc.if_else(rows["event"] == COMPUTE, compute, message)
    return pc.if_else((rows["event"] == COMPUTE) | (rows["kind"] != NONE), about, "")


def _whole(numbers: NDArray[np.integer]) -> Texts:
    return pc.cast(pa.array(np.ascontiguousarray(numbers)), pa.string())


def _us(times_ps: Times) -> Texts:
    """Microseconds with six decimals: exact picoseconds."""
    decimals = pc.utf8_lpad(_whole(times_ps % PS_PER_US), 6, "0")
    return pc.binary_join_element_wise(_whole(times_ps // PS_PER_US), decimals, ".")
