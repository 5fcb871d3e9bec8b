"""Rounds of rays: roots of the next one start when all rays of the one before are finished.

A round is over when it and all before it have no ray left. With a window of w rounds the end of
round k lets round k + w begin: it is known to all PEs a barrier's time after the last ray's end,
and each looks whenever it begins or ends an activity, or is woken then. No protocol of termination
is simulated, only that time, in which who has nothing to do waits. Where the next round's rays
depend on a maximum over all PEs (the shooter of progressive radiosity), each PE pays for that
reduction as an activity before it goes on.

An example, window 1, a barrier of 30: rounds of two and one roots on PE 0 and PE 1. PE 0's ray is
finished at 100, PE 1's at 140; round 1 begins at 170, and no one computes from 140 to 170.

A PE's roots lie in ``pixels`` by round; those of rounds that have not begun are no load, and are
neither ready nor held. Their part of the row is ``later`` ... ``later_end``.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import NONE, Row, Run
from simmpp.engine.arrays.views import pes, pixels, ray_rounds, rays, rounds
from simmpp.engine.pe.stealing import end_spell
from simmpp.engine.record.counters import note_load, note_work
from simmpp.engine.record.log import note_reduction


@kernel
def count_in_round(s: Run, ray: int, n_more: int, now_ps: int) -> None:
    """A ray is finished; its round has so many more rays left than before."""
    its = rounds(s)[ray_rounds(s)[ray]]
    its.left += n_more
    its.end_ps = max(its.end_ps, now_ps)


@kernel
def end_rounds(s: Run, last: int, end_ps: int) -> None:
    """A go is over, with rays finished that are linked from ``last`` on; NONE: at times of their
    own, which are known. Rounds that are over now let others begin."""
    while last != NONE:
        its = rounds(s)[ray_rounds(s)[last]]
        its.end_ps = max(its.end_ps, end_ps)
        last = rays(s)[last].next
    while s.n_over < s.n_rounds and rounds(s)[s.n_over].left == 0:
        s.over_ps = max(s.over_ps, rounds(s)[s.n_over].end_ps)
        if s.n_over + s.window < s.n_rounds:
            rounds(s)[s.n_over + s.window].begin_ps = s.over_ps + s.barrier_ps
        s.n_over += 1
    announce_round(s)


@kernel
def announce_round(s: Run) -> None:
    """Let the engine know when the next round begins, unless it does or nobody knows yet."""
    if s.is_announced == 0 and s.next_round < s.n_rounds:
        s.round_ps = rounds(s)[s.next_round].begin_ps
        s.is_announced = 1 if s.round_ps != NONE else 0


@kernel
def round_begins(s: Run) -> None:
    """The time that was announced is there: who sleeps is woken, and the next one may be told."""
    s.next_round += 1
    s.is_announced, s.round_ps = 0, NONE
    announce_round(s)


@kernel
def start_rounds(s: Run, me: int, now_ps: int) -> bool:
    """Start the roots of rounds that have begun by now; has any?"""
    pe, before = pes(s)[me], pes(s)[me].round
    while pe.round < s.n_rounds and 0 <= rounds(s)[pe.round].begin_ps <= now_ps:
        _start_round(s, pe)
        pe.owes_ps += s.choosing_ps
    if s.record_counters and pe.round > before:
        note_load(s, me, now_ps)
    return pe.round > before


@kernel
def _start_round(s: Run, pe: Row) -> None:
    first = pe.later
    while pe.later < pe.later_end and ray_rounds(s)[pixels(s)[pe.later]] == pe.round:
        pe.later += 1
    if pe.later > first:
        # Else what is left of rounds before lies right before it.
        if pe.pixel == pe.pixel_end:
            pe.pixel = first
        pe.pixel_end = pe.later
        pe.n_ready += pe.later - first
        pe.load += pe.later - first
        pe.peak_rays = max(pe.peak_rays, pe.load)
    if s.steals:
        end_spell(pe)  # whoever was asked in vain before may have some now
    pe.round += 1


@kernel
def reduce(s: Run, me: int, now_ps: int) -> int:
    """Take part in the reductions that rounds have begun with; returns the end of that."""
    pe = pes(s)[me]
    end_ps = now_ps + pe.owes_ps
    pe.communication_ps += pe.owes_ps
    pe.owes_ps, pe.received_load = 0, 0
    if s.logs:
        note_reduction(s, me, now_ps, end_ps)
    if s.record_counters:
        note_work(s, me, now_ps, end_ps, end_ps)
    return end_ps
