"""The event log: one row per activity and per arrival, in the order in which they happened."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.compiled import njit_reading as njit
from simmpp.engine.layout import ARRIVAL, COMPUTE, NONE, RECEIVE, Run
from simmpp.engine.memory import log, messages, pes
from simmpp.engine.state import State

EVENT_KINDS = ("arrival", "receive", "compute")
"""Names of the field ``event``: ARRIVAL, RECEIVE, COMPUTE."""


@njit
def note_arrival(runs: NDArray[np.void], message: int) -> None:
    """A message reached its destination's inbox."""
    s: Run = runs[0]
    m, event = messages(s)[message], log(s)[s.n_logged]
    event.time_ps, event.end_ps = m.arrival_ps, m.arrival_ps
    event.pe, event.event, event.tests = m.destination, ARRIVAL, 0
    _note_message(s, message)
    s.n_logged += 1


@njit
def note_begin(s: Run, me: int, message: int, now_ps: int) -> None:
    """An activity begins: the receipt of ``message``, or a compute activity if that is NONE."""
    event = log(s)[s.n_logged]
    event.time_ps, event.end_ps = now_ps, NONE
    event.pe, event.tests = me, 0
    if message == NONE:
        event.event, event.payload_bytes = COMPUTE, 0
        event.source, event.kind, event.number = NONE, NONE, NONE
    else:
        event.event = RECEIVE
        _note_message(s, message)
    pes(s)[me].open_event = s.n_logged
    s.n_logged += 1


@njit
def note_end(s: Run, me: int, now_ps: int) -> None:
    """The last activity of a PE, if it has one, has ended."""
    pe = pes(s)[me]
    if pe.open_event != NONE:
        log(s)[pe.open_event].end_ps = now_ps
        pe.open_event = NONE


@njit
def _note_message(s: Run, message: int) -> None:
    m, event = messages(s)[message], log(s)[s.n_logged]
    event.source, event.kind = m.source, m.kind
    event.number, event.payload_bytes = m.number, m.payload_bytes


def events(state: State, makespan_ps: int) -> NDArray[np.void]:
    """All rows, (events,) EVENT; activities that the end of the run cut short end there."""
    rows = state.arrays["log"][: state["n_logged"]].copy()
    unfinished = (rows["end_ps"] == NONE) | (rows["end_ps"] > makespan_ps)
    rows["end_ps"][unfinished] = makespan_ps
    return rows
