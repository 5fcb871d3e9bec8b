"""A timeline: what each PE does from the start to the end of a run, without gaps.

The event log says when a PE computes, receives and sends; what lies between is idle time, and the
look into an empty inbox, with which a computation begins, is told apart as a probe. All times are
integer picoseconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.engine.arrays.records import (
    ANSWER,
    ARRIVAL,
    COMPUTE,
    EVENT,
    NONE,
    RECEIVE,
    SEND,
    SERVE,
)
from simmpp.engine.record.log import EVENT_KINDS
from simmpp.machine.machine import NIC, POLLED, THREAD
from simmpp.machine.messages import RAYS

IDLE, PROBE = len(EVENT_KINDS), len(EVENT_KINDS) + 1
SLICE_KINDS = (*EVENT_KINDS, "idle", "probe")
"""Names of the field ``event`` of a slice."""
COMMUNICATION = (RECEIVE, SEND, PROBE)
"""Slices that a PE's account of communication is the sum of."""
OF_SERVERS = (SERVE, ANSWER)
"""Slices of who serves beside the PE: its thread, or its network card, which takes no time."""

Rows = NDArray[np.void]
Times = NDArray[np.int64]


@dataclass(frozen=True)
class Window:
    """The part of a run that is looked at."""

    start_ps: int = 0
    end_ps: int = np.iinfo(np.int64).max

    def holds(self, times_ps: Times) -> NDArray[np.bool_]:
        """Which instants lie in it; both ends do."""
        return (times_ps >= self.start_ps) & (times_ps <= self.end_ps)


@dataclass(frozen=True, eq=False)
class TimelinePart:
    """A stretch of a timeline: what some rows of the event log add to it."""

    slices: Rows
    """(n,) EVENT without arrivals, with IDLE and PROBE; those of a PE touch one another, those of
    what serves beside it come behind."""
    arrivals: Rows
    """(a,) EVENT."""
    loads: Rows
    """(c,) EVENT: slices at whose end the PE's load, or its ready part, was another than before."""
    arrows: Rows
    """(m,) EVENT: RECEIVE rows (SERVE, with threads) of messages of which both ends are in the
    window; with network cards what is got comes from there, and the get itself has none."""
    tails_ps: Times
    """(m,) int64: when the packing of the message of each arrow began,"""
    tails_served: NDArray[np.bool_]
    """(m,) bool: and whether it was an answer of what serves beside the PE."""
    flights_ps: Times
    """(f,) int64: when the number of messages in flight changed."""
    in_flight: Times
    """(f,) int64: their number from then on."""


class Timeline:
    """Makes a timeline of the rows of one run's event log, part by part, in bounded memory."""

    def __init__(
        self, processors: int, probe_ps: int, window: Window, service: str = POLLED
    ) -> None:
        self._service = service
        self._probe_ps = probe_ps
        self._window = window
        self._ended_ps = np.zeros(processors, np.int64)
        self._held = np.full((2, processors), NONE, np.int64)
        self._in_flight = 0
        self._packed = np.zeros((3, 0), np.int64)

    def add(self, rows: Rows) -> TimelinePart:
        """The part that more rows of the event log make."""
        arrived, served = rows["event"] == ARRIVAL, is_of_server(rows)
        slices = self._filled(rows[~arrived & ~served])
        if served.any():
            slices = np.concatenate([slices, rows[served]])
        return self._part(slices, rows[arrived])

    def end(self, makespan_ps: int) -> TimelinePart:
        """The last part: idle to the end."""
        idle = np.flatnonzero(self._ended_ps < makespan_ps)
        rows = _idle_rows(idle, self._ended_ps[idle], np.full(len(idle), makespan_ps))
        return self._part(rows, np.zeros(0, EVENT))

    def _part(self, slices: Rows, arrivals: Rows) -> TimelinePart:
        flights_ps, in_flight = self._flights(slices, arrivals)
        loads = self._changed(slices)
        slices = self._cut(slices)
        arrows, tails_ps, tails_served = self._arrows(slices)
        arrivals = arrivals[self._window.holds(arrivals["time_ps"])]
        return TimelinePart(
            slices, arrivals, loads, arrows, tails_ps, tails_served, flights_ps, in_flight
        )

    def _filled(self, work: Rows) -> Rows:
        """Work with what lies between: idle time, and the probes that computations begin with."""
        before_ps = _before(work["pe"], work["end_ps"], self._ended_ps)
        gaps = np.flatnonzero(work["time_ps"] > before_ps)
        idle = _idle_rows(work["pe"][gaps], before_ps[gaps], work["time_ps"][gaps])
        probing = np.flatnonzero((work["event"] == COMPUTE) & (self._probe_ps > 0))
        probes = work[probing]
        work = work.copy()
        work["time_ps"][probing] += self._probe_ps
        probes["event"], probes["end_ps"] = PROBE, work["time_ps"][probing]
        probes["tests"] = probes["rays"] = 0
        probes["load"] = probes["ready"] = NONE  # not known in between
        # Row n of the work is at 3 n + 2, its probe at 3 n + 1, the idle time before at 3 n.
        places = (3 * gaps, 3 * probing + 1, 3 * np.arange(len(work)) + 2)
        order = np.argsort(np.concatenate(places))
        filled: Rows = np.concatenate([idle, probes, work])[order]
        return filled

    def _changed(self, slices: Rows) -> Rows:
        """Slices in the window that left the PE with other rays than it had before."""
        loaded = slices[slices["load"] != NONE]
        same = [
            _before(loaded["pe"], loaded[name].astype(np.int64), last) == loaded[name]
            for name, last in zip(("load", "ready"), self._held, strict=True)
        ]
        changed: Rows = loaded[~(same[0] & same[1]) & self._window.holds(loaded["end_ps"])]
        return changed

    def _cut(self, slices: Rows) -> Rows:
        """Slices cut at the edges of the window; those outside left out."""
        window = self._window
        begins_ps, ends_ps = slices["time_ps"], slices["end_ps"]
        inside = (ends_ps > window.start_ps) & (begins_ps < window.end_ps)
        inside |= (begins_ps == ends_ps) & window.holds(begins_ps)
        slices = slices[inside]
        slices["time_ps"] = np.maximum(slices["time_ps"], window.start_ps)
        slices["end_ps"] = np.minimum(slices["end_ps"], window.end_ps)
        return slices

    def _arrows(self, slices: Rows) -> tuple[Rows, Times, NDArray[np.bool_]]:
        """Messages received here, and when their packing began: sends are kept until then."""
        sent = slices[_departs(slices)]
        if self._service == NIC:  # no one receives a get
            sent = sent[(sent["event"] == ANSWER) | (sent["kind"] == RAYS)]
        received = slices[slices["event"] == (SERVE if self._service == THREAD else RECEIVE)]
        keys = _keys(sent["pe"], sent["number"])
        packed = np.array([keys, sent["time_ps"], sent["event"] == ANSWER], np.int64)
        packed = np.concatenate([self._packed, packed], axis=1)
        packed = packed[:, np.argsort(packed[0])]
        keys = _keys(received["other"], received["number"])
        places = np.searchsorted(packed[0], keys)
        # A message that was sent before the window has no tail in it, and so no arrow.
        has_tail = np.append(packed[0], NONE)[places] == keys
        places = places[has_tail]
        tails_ps, tails_served = packed[1, places], packed[2, places] == 1
        self._packed = np.delete(packed, places, axis=1)
        return received[has_tail], tails_ps, tails_served

    def _flights(self, slices: Rows, arrivals: Rows) -> tuple[Times, Times]:
        """Messages in flight: departures and arrivals come in the order of time, part by part."""
        departed = slices["end_ps"][_departs(slices)]
        times_ps = np.concatenate([departed, arrivals["end_ps"]])
        changes = np.repeat([1, -1], [len(departed), len(arrivals)])
        order = np.argsort(times_ps, kind="stable")
        times_ps = times_ps[order]
        in_flight = self._in_flight + np.cumsum(changes[order])
        self._in_flight = int(in_flight[-1]) if len(in_flight) else self._in_flight
        # Of several changes at one instant only the number after the last is ever seen.
        is_last = np.diff(times_ps, append=NONE) != 0
        is_last &= self._window.holds(times_ps)
        return times_ps[is_last], in_flight[is_last]


def is_of_server(rows: Rows) -> NDArray[np.bool_]:
    """Which rows are of what serves beside a PE."""
    return np.isin(rows["event"], OF_SERVERS)


def _departs(rows: Rows) -> NDArray[np.bool_]:
    """Which rows are of messages that depart at their end."""
    return np.isin(rows["event"], (SEND, ANSWER)) & (rows["number"] != NONE)


def _before(pes: Rows, values: Times, last: Times) -> Times:
    """What each row's PE had in its row before, or in ``last`` (nb,), which is then renewed."""
    by_pe = np.argsort(pes, kind="stable")
    sorted_pes, sorted_values = pes[by_pe], values[by_pe]
    is_first = np.diff(sorted_pes, prepend=NONE) != 0
    before = np.empty_like(values)
    before[by_pe] = np.where(is_first, last[sorted_pes], np.roll(sorted_values, 1))
    last[sorted_pes] = sorted_values  # of equal PEs the last one stays
    return before


def _keys(pes: NDArray[Any], numbers: NDArray[Any]) -> Times:
    """A message by its sender and send number."""
    keys: Times = (pes.astype(np.int64) << 40) | numbers
    return keys


def _idle_rows(pes: NDArray[np.signedinteger], begins_ps: Times, ends_ps: Times) -> Rows:
    rows = np.zeros(len(pes), EVENT)
    rows["event"], rows["pe"], rows["time_ps"], rows["end_ps"] = IDLE, pes, begins_ps, ends_ps
    rows["other"] = rows["kind"] = rows["number"] = NONE
    rows["load"] = rows["ready"] = NONE
    return rows
