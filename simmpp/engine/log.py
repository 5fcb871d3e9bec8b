"""The event log: one row per activity and per arrival, in the order in which they happened."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.engine.layout import NO_ACTIVITY, NONE, RECEIVE
from simmpp.engine.state import State

ARRIVAL = 0
EVENT_KINDS = ("arrival", "receive", "compute")
"""Names of the field ``event``: ARRIVAL, then RECEIVE and COMPUTE of ``state``."""

EVENT = np.dtype(
    [
        ("time_ps", "i8"),  # when a message arrives, or an activity begins
        ("end_ps", "i8"),  # when the activity ends, dispatch included; of an arrival: time_ps
        ("pe", "i4"),  # destination of an arrival
        ("event", "i4"),  # ARRIVAL, RECEIVE or COMPUTE
        ("source", "i4"),  # sender of the message; -1 for COMPUTE
        ("kind", "i4"),  # kind of the message; -1 for COMPUTE
        ("number", "i8"),  # the sender's send number; -1 for COMPUTE
        ("payload_bytes", "i8"),
        ("tests", "i8"),
    ]
)


class ActivityLog:
    """Collects the rows of one run."""

    def __init__(self, processors: int) -> None:
        self._rows: list[list[int]] = []
        self._open: list[list[int] | None] = [None] * processors
        self._message = [NONE, NONE, NONE, 0]

    def about_to_step(self, state: State, message: int) -> None:
        """Remember the message that a step may consume; its place is free afterwards."""
        if message != NONE:
            self._message = _described(state, message)

    def stepped(
        self, me: int, began: int, tests: int, n_sent: int, now_ps: int, next_ps: int
    ) -> None:
        """PE ``me`` acted: its open activity ends, another one may begin."""
        row = self._open[me]
        if row is not None:
            # Without a new activity, what was sent went out in dispatch: it ends the activity.
            dispatched = began == NO_ACTIVITY and n_sent > 0
            row[1] = next_ps if dispatched else now_ps
            self._open[me] = None
        if began != NO_ACTIVITY:
            message = self._message if began == RECEIVE else [NONE, NONE, NONE, 0]
            row = [now_ps, NONE, me, began, *message, tests]
            self._open[me] = row
            self._rows.append(row)

    def arrived(self, state: State, message: int) -> None:
        """A message reached its destination's inbox."""
        time_ps = int(state.messages["arrival_ps"][message])
        destination = int(state.messages["destination"][message])
        self._rows.append([time_ps, time_ps, destination, ARRIVAL, *_described(state, message), 0])

    def events(self, makespan_ps: int) -> NDArray[np.void]:
        """All rows, (events,) EVENT; activities that the end cut short end there."""
        events = np.array([tuple(row) for row in self._rows], EVENT)
        unfinished = (events["end_ps"] == NONE) | (events["end_ps"] > makespan_ps)
        events["end_ps"][unfinished] = makespan_ps
        return events


def _described(state: State, message: int) -> list[int]:
    m = state.messages[message]
    return [int(m[name]) for name in ("source", "kind", "number", "payload_bytes")]
