"""The readable engine: PEs are SimPy processes, messages are events.

It stays lean so that whole pictures can be run: one event per message, scheduled at its arrival
(with contention one more at each link and port), inboxes are plain deques, and a sleeping PE has
one event to wake it. Ties in time are ordered by the priority of an event, a whole number made of
(0, destination, source, send number) for arrivals, of (1, PE, number) for the PEs' own instants
and of (2, source, send number) for heads of messages at links and ports.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Generator

import numpy as np
import simpy
from numpy.typing import NDArray
from simpy.events import Event

from simmpp.common.compiled import entry_point, njit
from simmpp.engine.arrays.records import (
    BEGIN,
    BY_NIC,
    BY_THREAD,
    MESSAGE,
    NONE,
    SLEEP,
    WOKEN,
    Run,
)
from simmpp.engine.arrays.views import messages
from simmpp.engine.network import move_head
from simmpp.engine.pe.bounds.rooms import note_arrival_of
from simmpp.engine.pe.gets import is_get, send_back
from simmpp.engine.pe.serving import serve
from simmpp.engine.pe.step import step
from simmpp.engine.pe.tables.rounds import round_begins
from simmpp.engine.record.log import note_arrival
from simmpp.engine.state import State

_HEAD_PS, _ARRIVAL_PS, _NUMBER, _SOURCE, _DESTINATION = (
    list(MESSAGE.names or ()).index(name)
    for name in ("head_ps", "arrival_ps", "number", "source", "destination")
)
_FIRST = -1  # priority before all others of its instant
_ROUND = ((1 << 64) - 1) << 64  # after arrivals, before instants
_PROGRESS_EVERY = 4096


@njit
def _step(runs: NDArray[np.void], me: int, phase: int, message: int, now_ps: int) -> int:
    return step(runs[0], me, phase, message, now_ps)


@njit
def _serve(runs: NDArray[np.void], me: int, message: int, now_ps: int) -> int:
    return serve(runs[0], me, message, now_ps)


@njit
def _send_back(runs: NDArray[np.void], message: int) -> bool:
    """Answer a message that has arrived, if a network card does."""
    s: Run = runs[0]
    if not is_get(messages(s)[message]):
        return False
    send_back(s, message)
    return True


@njit
def _move_head(runs: NDArray[np.void], message: int) -> int:
    return move_head(runs[0], message)


@njit
def _round_begins(runs: NDArray[np.void]) -> None:
    round_begins(runs[0])


@njit
def _note_arrival(runs: NDArray[np.void], message: int) -> None:
    s = runs[0]
    if s.logs:
        note_arrival(s, message)
    if s.measures:
        note_arrival_of(s, message)


class SimpyRun:
    """One run, on a SimPy environment whose clock counts integer picoseconds."""

    def __init__(self, state: State, progress: Callable[[int], None] | None = None) -> None:
        self.state = state
        self.arrivals = 0
        self._progress = progress
        self._note_arrival = entry_point(_note_arrival, state.runs, 0)
        self._move_head = entry_point(_move_head, state.runs, 0)
        self._step = entry_point(_step, state.runs, 0, 0, 0, 0)
        self._by_thread = state["service"] == BY_THREAD
        if self._by_thread:
            self._serve = entry_point(_serve, state.runs, 0, 0, 0)
        self._by_nic = state["service"] == BY_NIC
        if self._by_nic:
            self._send_back = entry_point(_send_back, state.runs, 0)
        if state["n_rounds"] > 1:
            self._round_begins = entry_point(_round_begins, state.runs)
        self._environment = simpy.Environment()
        # Of PEs, then of their threads.
        servers = state.arrays["processes"]
        self._inboxes: list[deque[int]] = [deque() for _ in servers]
        self._asleep: list[Event | None] = [None] * len(servers)
        self._numbers = [0] * len(servers)
        self._end = _happened(self._environment)
        self._ending = False
        self._logs = bool(state["logs"])
        self._notes = self._logs or bool(state["measures"])
        self._contends = bool(state["contends"])

    def run(self) -> None:
        """Run until no ray is left.

        Raises ModelError if rays are left and nothing is scheduled.
        """
        if self.state["rays_left"] == 0:
            return
        for me in range(len(self.state.pes)):
            self._environment.process(self._processing_element(me))
            if self._by_thread:
                self._environment.process(self._thread(me))
        events = 0
        while self._environment.peek() != simpy.core.Infinity and not self._end.processed:
            self._environment.step()
            events += 1
            if self._progress is not None and events % _PROGRESS_EVERY == 0:
                self._progress(self.state["rays_left"])
        if not self._ending:
            self.state.starve()

    def _processing_element(self, me: int) -> Generator[Event, None, None]:
        """One PE: a step at each of its instants, asleep between them."""
        environment, inbox, state = self._environment, self._inboxes[me], self.state
        step, runs = self._step, state.runs
        phase = BEGIN
        yield self._instant(me, 0)
        while True:
            now_ps = environment.now
            state.ensure_room(now_ps)
            message = inbox[0] if inbox else NONE
            next_ps = step(runs, me, phase, message, now_ps)
            phase, consumed, n_sent, round_ps, _ = state.report.tolist()
            if consumed:
                inbox.popleft()
            if n_sent:
                self._carry(n_sent)
            if round_ps != NONE:
                self._schedule_round(round_ps)
            if runs["rays_left"][0] == 0 and not self._ending:
                self._finish()
            yield self._next(me, next_ps, wakes=phase == WOKEN)

    def _thread(self, me: int) -> Generator[Event, None, None]:
        """What receives for a PE: asleep until there is something."""
        environment, state, pes = self._environment, self.state, len(self.state.pes)
        inbox = self._inboxes[pes + me]
        yield self._next(pes + me, SLEEP)
        while True:
            now_ps = environment.now
            state.ensure_room(now_ps)
            message = inbox[0] if inbox else NONE
            next_ps = self._serve(state.runs, me, message, now_ps)
            _, consumed, n_sent, _, handed = state.report.tolist()
            if consumed:
                inbox.popleft()
            if handed != NONE:
                self._put(me, handed)
            self._carry(n_sent)
            yield self._next(pes + me, next_ps)

    def _next(self, me: int, next_ps: int, *, wakes: bool = False) -> Event:
        """The next instant of a PE or thread, or what will wake it; that may be the time itself."""
        delay_ps = next_ps - self._environment.now
        if next_ps != SLEEP and not wakes:
            return self._instant(me, delay_ps)
        self._asleep[me] = asleep = _happened(self._environment)
        if wakes:
            self._schedule_waking(me, delay_ps)
        return asleep

    def _instant(self, me: int, delay_ps: int) -> Event:
        """The next instant of a PE or thread."""
        event = _happened(self._environment)
        self._schedule_instant(me, event, delay_ps)
        return event

    def _schedule_instant(self, me: int, event: Event, delay_ps: int) -> None:
        self._numbers[me] += 1
        self._environment.schedule(event, self._priority(me), delay_ps)

    def _priority(self, me: int) -> int:
        """Of the instant of a PE that was scheduled last."""
        return (1 << 64 | me) << 64 | self._numbers[me]

    def _schedule_waking(self, me: int, delay_ps: int) -> None:
        """An instant at which a sleeping PE is woken, unless a message wakes it before."""
        waking = _happened(self._environment)
        self._schedule_instant(me, waking, delay_ps)
        waking._value = me, self._numbers[me]
        waking.callbacks.append(self._wake)

    def _wake(self, waking: Event) -> None:
        """Now is the time: in this very instant, before all else, the PE goes on."""
        me, number = waking.value
        asleep = self._asleep[me]
        if asleep is not None and number == self._numbers[me]:
            self._asleep[me] = None
            self._environment.schedule(asleep, self._priority(me), 0)

    def _carry(self, n_sent: int) -> None:
        """Messages of the outbox travel; with contention from one port or link to the next."""
        for row in self.state.arrays["outbox"][:n_sent].tolist():
            self._travel(row)

    def _travel(self, row: int) -> None:
        if self._contends:
            message = self.state.messages[row].item()
            priority = (2 << 64 | message[_SOURCE]) << 64 | message[_NUMBER]
            self._schedule_head(row, priority, message[_HEAD_PS])
        else:
            self._let_arrive(row)

    def _schedule_head(self, row: int, priority: int, time_ps: int) -> None:
        head = _happened(self._environment, (row, priority))
        head.callbacks.append(self._move)
        self._environment.schedule(head, priority, time_ps - self._environment.now)

    def _move(self, head: Event) -> None:
        """The head of a message is at a port or link: it goes on, or the message arrives."""
        row, priority = head.value
        if self._logs:
            self.state.ensure_room(self._environment.now)
        next_ps = self._move_head(self.state.runs, row)
        if self.state.messages["arrival_ps"][row] != NONE:
            self._let_arrive(row)
        else:
            self._schedule_head(row, priority, next_ps)

    def _let_arrive(self, row: int) -> None:
        message = self.state.messages[row].item()
        destination = message[_DESTINATION]
        arrival = _happened(self._environment, (destination, row))
        arrival.callbacks.append(self._deliver)
        priority = (destination << 32 | message[_SOURCE]) << 64 | message[_NUMBER]
        delay_ps = message[_ARRIVAL_PS] - self._environment.now
        self._environment.schedule(arrival, priority, delay_ps)

    def _deliver(self, arrival: Event) -> None:
        """A message arrives, for its PE or thread; a network card answers what is for it."""
        destination, row = arrival.value
        self.arrivals += 1
        if self._logs:
            self.state.ensure_room(self._environment.now)
        if self._notes:
            self._note_arrival(self.state.runs, row)
        if self._by_nic and self._send_back(self.state.runs, row):
            self._travel(row)
        else:
            self._put(destination + len(self.state.pes) * self._by_thread, row)

    def _put(self, me: int, row: int) -> None:
        """Put a message into the inbox of a PE or thread, and wake that if it sleeps."""
        self._inboxes[me].append(row)
        self._rouse(me)

    def _rouse(self, me: int) -> None:
        asleep = self._asleep[me]
        if asleep is not None:
            self._asleep[me] = None
            self._schedule_instant(me, asleep, 0)

    def _schedule_round(self, time_ps: int) -> None:
        beginning = _happened(self._environment)
        beginning.callbacks.append(self._begin_round)
        self._environment.schedule(beginning, _ROUND, time_ps - self._environment.now)

    def _begin_round(self, beginning: Event) -> None:
        """All know that a round begins, and go on."""
        self._round_begins(self.state.runs)
        for me in range(len(self.state.pes)):
            self._rouse(me)
        if (round_ps := int(self.state.runs["round_ps"][0])) != NONE:
            self._schedule_round(round_ps)

    def _finish(self) -> None:
        """No ray is left: stop at the end of the last ray's last cost, before all else there."""
        self._ending = True
        end_ps = self.state["last_ray_ps"]
        self._environment.schedule(self._end, _FIRST, end_ps - self._environment.now)


def _happened(environment: simpy.Environment, value: object = None) -> Event:
    """An event that only has to be scheduled: it succeeds when its time comes."""
    event = Event(environment)
    event._ok, event._value = True, value
    return event
