"""The model: what one PE does in a step, and what that costs.

A PE alternates between two instants. At BEGIN it starts an activity: it receives the oldest message
of its inbox, or else computes up to a quantum of tests; at DISPATCH, when that work is done, its
policy sends and asks, as part of the activity. Engines call ``step`` at each instant and carry the
messages that it leaves in the outbox; they know nothing of rays, objects or policies.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import find
from simmpp.engine.arrays.records import (
    BEGIN,
    DISPATCH,
    NONE,
    SAMPLED,
    SLEEP,
    WOKEN,
    Row,
    Run,
)
from simmpp.engine.arrays.views import (
    itinerary_objects,
    itinerary_offsets,
    leaves,
    misses,
    pes,
    rays,
    rooms,
    tested_objects,
    tested_rays,
)
from simmpp.engine.pe.bounds.admission import can_unpack, unpack
from simmpp.engine.pe.bounds.escape import ESCAPED
from simmpp.engine.pe.bounds.rooms import has_ready, note_memory, rays_held
from simmpp.engine.pe.dispatch import dispatch
from simmpp.engine.pe.fetched import touch, unpin
from simmpp.engine.pe.misses import file_ray, is_in_memory
from simmpp.engine.pe.pace import cost_of_test_ps, pace_of, paced_ps, took
from simmpp.engine.pe.peers import sample_loads
from simmpp.engine.pe.ready import end_together, finish_ray, next_ready, pop_ready
from simmpp.engine.pe.receiving import receive
from simmpp.engine.pe.tables.rounds import end_rounds, reduce, start_rounds
from simmpp.engine.pe.tables.tallies import leave
from simmpp.engine.pe.talking import get_on, rest, wake
from simmpp.engine.record.counters import note_finished, note_held, note_load, note_work
from simmpp.engine.record.log import note_compute
from simmpp.machine.limits import CLOCK_LIMIT_PS


@kernel
def step(s: Run, me: int, phase: int, message: int, now_ps: int) -> int:
    """Act on an instant of PE ``me``; ``message`` is the oldest of its inbox, or NONE.

    Returns the time of the PE's next instant in picoseconds, or SLEEP until a message arrives. The
    record's REPORT fields then hold the phase of that instant, whether the message was consumed
    and the number of messages in the outbox. With phase WOKEN the PE sleeps as well: a message
    that arrives before that time wakes it, and there is no such instant any more.
    """
    s.phase, s.consumed, s.n_sent, s.round_ps = BEGIN, 0, 0, NONE
    if s.load_info == SAMPLED and now_ps >= s.next_sample_ps:
        sample_loads(s, now_ps)
    pe = pes(s)[me]
    next_ps = now_ps
    if s.n_rounds > 1 and start_rounds(s, me, now_ps):
        note_peaks(s, pe)
        phase = BEGIN if phase == WOKEN else phase
    if phase == WOKEN and message == NONE:
        wake(s, me, now_ps)
        phase = DISPATCH
    if phase == DISPATCH:
        next_ps = dispatch(s, me, message == NONE, now_ps)
    # What was sent departs by now; a dispatch that sent nothing took no time, so the next activity
    # begins in this very instant, with the inbox as it was before.
    if s.n_sent == 0:
        next_ps = _begin(s, me, phase, message, now_ps)
    if s.measures:
        note_memory(s, me)
        if s.record_counters:
            note_held(s, me, rays_held(s, me), now_ps)
    if s.phase != WOKEN:
        pe.busy_until_ps = max(pe.busy_until_ps, next_ps)
    if next_ps > CLOCK_LIMIT_PS:
        raise OverflowError("the clock")
    return next_ps


@kernel
def _begin(s: Run, me: int, phase: int, message: int, now_ps: int) -> int:
    """The last activity has ended: receive, compute or sleep."""
    pe = pes(s)[me]
    # Others see this one (load_info exact), never a load in the middle of an activity.
    pe.settled_load = pe.load
    unpacks = message == NONE and s.bounded and can_unpack(s, me)
    reduces = pe.owes_ps > 0
    if message == NONE and not (unpacks or reduces) and not has_ready(s, me):
        return rest(s, me, phase, now_ps) if s.idle != 0 or s.steals else SLEEP
    s.activities += 1
    if s.bounded:
        _require_progress(s)
    s.phase = DISPATCH
    if reduces:
        next_ps = reduce(s, me, now_ps)
    elif message != NONE:
        s.consumed = 1
        next_ps = receive(s, me, message, now_ps)
    elif unpacks:
        next_ps = unpack(s, me, now_ps)
    else:
        next_ps = compute(s, me, now_ps)
    note_peaks(s, pe)
    return next_ps


@kernel
def _require_progress(s: Run) -> None:
    """No more than so many activities lie between two tests or finished rays (``bounds.escape``).

    Most seen in random cases on 8 PEs: 1,460.
    """
    nb = s.processors
    if s.activities - s.progress_at > 10 * nb**3 + 200 + 10 * nb * s.rays_left:
        raise RuntimeError("no progress")


@kernel
def note_peaks(s: Run, pe: Row) -> None:
    """The most that a PE holds at the start or after the work of an activity."""
    pe.peak_object_bytes = max(pe.peak_object_bytes, pe.held_bytes)
    pe.peak_bytes = max(pe.peak_bytes, pe.held_bytes + pe.load * s.ray_bytes)


@kernel
def compute(s: Run, me: int, now_ps: int) -> int:
    """Make up to a quantum of tests on ready rays; returns the end of that work."""
    pe = pes(s)[me]
    begin_ps = now_ps + s.probe_ps + s.compute_startup_ps
    pace, cost_ps = pace_of(s, me, now_ps), 0
    pe.received_load = 0
    tests, done, last = 0, s.rays_done, NONE
    while tests < s.quantum and has_ready(s, me):
        ray = next_ready(s, me)
        r = rays(s)[ray]
        at, end = itinerary_offsets(s)[ray] + r.tested, itinerary_offsets(s)[ray + 1]
        while at < end:
            obj = itinerary_objects(s)[at]
            # What a ray was granted may have left the transient memory again: it is pinned for it.
            if r.granted == 0 and not is_in_memory(s, me, obj):
                pop_ready(s, me)
                file_ray(s, me, ray, obj)
                break
            # Only here: a ray that fills the quantum still leaves if it is done or lacks an
            # object, as neither costs a test.
            if tests == s.quantum:
                pe.cut = 1
                break
            cost_ps += cost_of_test_ps(s, ray, obj)
            _test(s, me, ray, obj, at)
            tests, at = tests + 1, at + 1
            if r.granted or s.keeps:
                _use(s, me, ray, obj, begin_ps + paced_ps(cost_ps, pace))
        else:
            cost_ps += s.ray_ps
            pop_ready(s, me)
            finish_ray(s, me, ray, begin_ps + paced_ps(cost_ps, pace))
            r.next, last = last, ray
    took_ps = took(s, me, cost_ps, tests, s.rays_done - done, pace)
    return _end_go(s, me, now_ps, took_ps, tests, s.rays_done - done, last)


@kernel
def _end_go(s: Run, me: int, now_ps: int, took_ps: int, tests: int, done: int, last: int) -> int:
    """A go at computing has made tests, and is done with rays, linked from ``last`` on."""
    pe, start_ps = pes(s)[me], now_ps + s.probe_ps
    end_ps = start_ps + took_ps
    if done > 0:
        # Whatever followed the last of these rays was for others, which are finished later.
        s.last_ray_ps = max(s.last_ray_ps, end_ps)
        are_together = 0 < tests < s.least_tests
        if s.record_ends and are_together:
            end_together(s, last, end_ps)
        if s.n_rounds > 1:
            end_rounds(s, last if are_together else NONE, end_ps)
    if tests > 0 or done > 0:
        s.progress_at = s.activities
        get_on(pe)
    if s.logs:
        note_compute(s, me, tests, done, now_ps, end_ps)
    if s.record_counters:
        note_work(s, me, now_ps, start_ps, end_ps)
        note_load(s, me, end_ps)
        note_finished(s, done, end_ps)
    pe.compute_ps += took_ps
    pe.communication_ps += s.probe_ps
    return end_ps


@kernel
def _test(s: Run, me: int, ray: int, obj: int, at: int) -> None:
    """One ray-object intersection, at that place of all itineraries; what it finds is in the
    workload."""
    if s.record_tests:
        tested_rays(s)[s.tests], tested_objects(s)[s.tests] = ray, obj
    s.tests += 1
    if s.leaves_n > 0 and leaves(s)[at] == 1:
        leave(s, me, ray, obj)
    rays(s)[ray].tested += 1


@kernel
def _use(s: Run, me: int, ray: int, obj: int, now_ps: int) -> None:
    """A test is over against an object that may have been fetched: it is used, or let go."""
    r = rays(s)[ray]
    goes_on = r.granted != 0 and _needs_again(s, ray, obj)
    miss_row = find(misses(s), me * s.n_objects + obj)
    if miss_row != NONE:  # a resident object has none
        touch(s, me, miss_row)
        if r.granted == 1 and not goes_on:
            unpin(s, me, miss_row, obj, now_ps)
    if goes_on:  # what was granted for this test is for the next one as well
        return
    if r.granted == ESCAPED:
        rooms(s)[me].stuck = NONE
    r.granted = 0


@kernel
def _needs_again(s: Run, ray: int, obj: int) -> bool:
    """Is the ray's next test against the same object, as of a particle that stays in its cell?"""
    at = itinerary_offsets(s)[ray] + rays(s)[ray].tested
    return at < itinerary_offsets(s)[ray + 1] and itinerary_objects(s)[at] == obj
