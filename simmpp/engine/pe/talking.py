"""Messages of the policy's own: hooks heard and idle, and the time that idle wants to be woken at.

A message is USER_WORDS numbers; it is sent, travels and is received as any other. Whatever the
hooks say, a run ends: between two things that get a PE on (a test, a finished ray, a message with
rays, pixels or objects) it sends at most 2 (nb - 1) of them, nb of its island, and is woken as many
times, at least WAKING_PS apart.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import (
    BY_NIC,
    BY_THREAD,
    NONE,
    PACK,
    REST,
    SLEEP,
    UNPACK,
    WOKEN,
    Row,
    Run,
)
from simmpp.engine.arrays.views import copy_costs, messages, pes, topology, user_words
from simmpp.engine.network import flight_ps
from simmpp.engine.pe.costs import copy_ps, sent_alone_ps, taken_in_ps
from simmpp.engine.pe.peers import peer_of
from simmpp.engine.pe.sending import send_user
from simmpp.engine.pe.showing import show_load, show_nothing, show_self, view_of
from simmpp.engine.pe.stealing import steal
from simmpp.engine.record.counters import note_work
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.messages import USER, USER_WORDS, WORD_BYTES
from simmpp.machine.topology import hops
from simmpp.policy.record import consult
from simmpp.policy.view import LOADS, WAY, View

WAKING_PS = 1_000_000
"""Between two times that a PE is woken, and from the start to the first: 1 us."""


@kernel
def get_on(pe: Row) -> None:
    """The PE has made a test, finished a ray, or received rays, pixels or objects."""
    pe.user_sent, pe.wakes = 0, 0


@kernel
def hear(s: Run, me: int, message: int, now_ps: int) -> int:
    """Tell the policy the words of a message that has been unpacked, and answer as it says."""
    if s.heard == 0:
        return now_ps
    source = messages(s)[message].source
    view = view_of(s, me)
    _show(s, view, me, source, now_ps, s.heard_reads)
    view.nothing_else = 0
    for i in range(USER_WORDS):
        view.words[i] = user_words(s)[USER_WORDS * message + i]
    if consult(s.heard, view) <= 0:
        return now_ps
    return _say(s, view, me, source - pes(s)[me].base, now_ps)


@kernel
def rest(s: Run, me: int, phase: int, now_ps: int) -> int:
    """Nothing is to do: ask when to be woken, and whom to tell what; ask for pixels.

    Returns when the PE's next instant is if no message comes before, or SLEEP.
    """
    pe = pes(s)[me]
    pe.received_load = 0  # what is sent from here on is no answer to a load
    if phase != REST:
        clock_ps = _ask(s, me, pe, now_ps) if s.idle != 0 else now_ps
        if s.steals:
            clock_ps = steal(s, me, clock_ps)
        if s.record_counters and clock_ps > now_ps:
            note_work(s, me, now_ps, clock_ps, clock_ps)
        pe.communication_ps += clock_ps - now_ps
        if s.n_sent > 0:
            s.phase = REST
            return clock_ps
    if pe.wake_ps <= 0 or pe.wakes >= _most(s):
        return SLEEP
    wake_ps = max(pe.wake_ps, now_ps, pe.woken_ps + WAKING_PS)
    if wake_ps > CLOCK_LIMIT_PS:
        return SLEEP
    s.phase = WOKEN
    return wake_ps


@kernel
def wake(s: Run, me: int, now_ps: int) -> None:
    """The time that the policy wanted to be woken at is there."""
    pe = pes(s)[me]
    pe.wakes += 1
    pe.woken_ps = now_ps


@kernel
def _most(s: Run) -> int:
    return 2 * (s.island - 1)


@kernel
def _ask(s: Run, me: int, pe: Row, now_ps: int) -> int:
    """Ask ``idle``, and send what it says; returns the end of that."""
    view = view_of(s, me)
    _show(s, view, me, NONE, now_ps, s.idle_reads)
    view.nothing_else = 1
    for i in range(USER_WORDS):
        view.words[i] = 0
    pe.wake_ps = consult(s.idle, view)
    if view.other == NONE:
        return now_ps
    return _say(s, view, me, view.other, now_ps)


@kernel
def _say(s: Run, view: View, me: int, place: int, now_ps: int) -> int:
    """Send the words in the view to a PE of the island; what is for nobody, or one too many, is
    dropped."""
    pe = pes(s)[me]
    is_someone = 0 <= place < s.island and place != pe.place
    if not is_someone or pe.user_sent >= _most(s):
        s.user_dropped += 1
        return now_ps
    pe.user_sent += 1
    return send_user(s, me, pe.base + place, view, now_ps)


@kernel
def _show(s: Run, view: View, me: int, other: int, now_ps: int, reads: int) -> None:
    """Show ``heard`` who has sent a message, ``idle`` nobody."""
    pe = pes(s)[me]
    view.load, view.other = pe.load, NONE if other == NONE else other - pe.base
    view.waiting, view.unasked = pe.load - pe.n_ready, 0
    if reads == 0:
        return
    show_nothing(view)
    view.objects = view.fetch_ps = view.fetch_flight_ps = 0
    if reads & LOADS:
        view.known_load, view.age_ps, view.in_flight = NONE, now_ps, 0
        if other != NONE:
            show_load(s, view, peer_of(s, me, other), now_ps)
    if reads & WAY:
        _show_way(s, view, me, other)
    show_self(s, view, me, now_ps, reads)


@kernel
def _show_way(s: Run, view: View, me: int, other: int) -> None:
    """What words cost on their way to another PE; to nobody yet without the startups of a level."""
    n_bytes = USER_WORDS * WORD_BYTES
    if other == NONE:
        view.send_ps = s.send_startup_ps + copy_ps(copy_costs(s)[PACK + USER], n_bytes)
        receipt_ps = s.completion_ps if s.service == BY_NIC else s.receive_startup_ps
        receipt_ps += copy_ps(copy_costs(s)[UNPACK + USER], n_bytes)
        view.receive_ps = s.handoff_ps if s.service == BY_THREAD else receipt_ps
        view.hops = view.flight_ps = 0
        return
    view.send_ps = sent_alone_ps(s, me, other, USER, n_bytes)
    view.receive_ps, by_thread_ps = taken_in_ps(s, me, other, USER, n_bytes)
    view.hops = hops(topology(s), me, other)
    view.flight_ps = flight_ps(s, me, other, n_bytes + s.header_bytes) + by_thread_ps
