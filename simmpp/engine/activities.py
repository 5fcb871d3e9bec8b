"""The model: what one PE does in a step, and what that costs.

A PE alternates between two instants. At BEGIN it starts an activity: it receives the oldest message
of its inbox, or else computes up to a quantum of tests; at DISPATCH, when that work is done, its
policy sends and asks, as part of the activity. Engines call ``step`` at each instant and carry the
messages that it leaves in the outbox; they know nothing of rays, objects or policies.
"""

from __future__ import annotations

from simmpp.compiled import njit
from simmpp.engine.dispatch import dispatch
from simmpp.engine.ready import finish_ray, make_ready, pop_ready
from simmpp.engine.sending import copy_ps, send
from simmpp.engine.state import (
    BEGAN,
    COMPUTE,
    CONSUMED,
    DISPATCH,
    NO_ACTIVITY,
    OUTBOX,
    PHASE,
    RAYS_LEFT,
    RECEIVE,
    TESTS,
    UNPACK,
    State,
)
from simmpp.engine.tables import NONE, find, give_back
from simmpp.engine.waiting import admit_object, file_ray, is_in_memory, partner_of, touch, unpin
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST

SLEEP = -1


@njit
def step(s: State, me: int, phase: int, message: int, now_ps: int) -> int:
    """Act on an instant of PE ``me``; ``message`` is the oldest of its inbox, or NONE.

    Returns the time of the PE's next instant in picoseconds, or SLEEP until a message arrives.
    ``s.report`` then holds that instant's PHASE, whether the message was CONSUMED, the number of
    messages in the OUTBOX, the activity that BEGAN (and its TESTS), and the RAYS_LEFT.
    """
    report = s.report
    report[:] = 0
    pe = s.pes[me]
    next_ps = now_ps
    if phase == DISPATCH:
        next_ps = dispatch(s, me, message == NONE, now_ps)
    if report[OUTBOX] == 0:
        pe.settled_load = pe.load
        if message != NONE:
            report[BEGAN], report[CONSUMED], report[PHASE] = RECEIVE, 1, DISPATCH
            next_ps = receive(s, me, message, now_ps)
        elif pe.n_ready > 0:
            report[BEGAN], report[PHASE] = COMPUTE, DISPATCH
            next_ps = compute(s, me, now_ps)
        else:
            next_ps = SLEEP
    if report[BEGAN] != NO_ACTIVITY:
        s.totals[0].activities += 1
        held = pe.held_bytes + pe.load * s.setup[0].ray_bytes
        pe.peak_bytes = max(pe.peak_bytes, held)
    pe.busy_until_ps = max(pe.busy_until_ps, next_ps)
    report[RAYS_LEFT] = s.totals[0].rays_left
    return next_ps


@njit
def receive(s: State, me: int, message: int, now_ps: int) -> int:
    """Unpack one message and do what it asks for; returns the end of that work."""
    pe, m, setup = s.pes[me], s.messages[message], s.setup[0]
    clock_ps = now_ps + setup.receive_startup_ps
    clock_ps += copy_ps(s.copy_costs[UNPACK, m.kind], m.payload_bytes)
    _hear(s, me, m.source, m.load, m.kind, clock_ps)
    pe.received_load = 1 if m.kind == LOAD else 0
    if m.kind == REQUEST:
        payload_bytes = s.object_bytes[m.object]
        clock_ps = send(s, me, m.source, OBJECT, m.object, NONE, NONE, 0, payload_bytes, clock_ps)
    elif m.kind == OBJECT:
        admit_object(s, me, m.object)
    elif m.kind == RAYS:
        pe.load += m.n
        pe.peak_rays = max(pe.peak_rays, pe.load)
        make_ready(s, me, m.first, m.last, m.n)
    s.totals[0].received += 1
    pe.communication_ps += clock_ps - now_ps
    m.kind = NONE
    give_back(s.messages, s.message_marks, message)
    return clock_ps


@njit
def _hear(s: State, me: int, source: int, load: int, kind: int, now_ps: int) -> None:
    """Remember the load in a header, and whom rays or objects came from."""
    setup = s.setup[0]
    refreshes = setup.refresh_ps != NONE and kind in (OBJECT, RAYS)
    if setup.listens or refreshes:
        partner = s.partners.rows[partner_of(s, me, source)]
        partner.load = load
        partner.heard_ps = now_ps
        if refreshes:
            partner.exchanged = 1


@njit
def compute(s: State, me: int, now_ps: int) -> int:
    """Make up to a quantum of tests on ready rays; returns the end of that work."""
    pe, setup = s.pes[me], s.setup[0]
    start_ps = now_ps + setup.probe_ps
    clock_ps = start_ps
    pe.received_load = 0
    tests = 0
    while tests < setup.quantum and pe.n_ready > 0:
        ray = pe.ready_first
        end = s.itinerary_offsets[ray + 1]
        while s.rays[ray].at < end:
            missing = s.itinerary_objects[s.rays[ray].at]
            if s.rays[ray].granted == 0 and not is_in_memory(s, me, missing):
                pop_ready(s, me)
                file_ray(s, me, ray, missing)
                break
            if tests == setup.quantum:
                break
            clock_ps += s.test_ps[missing]
            _test(s, me, ray, missing)
            tests += 1
        else:
            clock_ps += setup.ray_ps
            pop_ready(s, me)
            finish_ray(s, me, ray, clock_ps)
    s.totals[0].tests += tests
    s.report[TESTS] = tests
    pe.compute_ps += clock_ps - start_ps
    pe.communication_ps += setup.probe_ps
    return clock_ps


@njit
def _test(s: State, me: int, ray: int, tested: int) -> None:
    """One ray-object intersection; what it finds is in the workload."""
    if s.setup[0].record_tests:
        at = s.report[TESTS] + s.totals[0].tests
        s.tested_rays[at], s.tested_objects[at] = ray, tested
        s.report[TESTS] += 1
    r = s.rays[ray]
    r.at += 1
    if r.granted or s.setup[0].transient > 0:
        want = find(s.wants, me * s.setup[0].n_objects + tested)
        if want != NONE:
            touch(s, me, want)
            if r.granted:
                unpin(s, me, want, tested)
        r.granted = 0
