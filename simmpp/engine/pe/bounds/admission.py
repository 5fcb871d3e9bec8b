"""Rays that have come and lie in the share of their sender, until there is room for them.

A message of which rays are left stays where it is; those of a PE are in one list, the oldest first.
A ray that does not fit lets a later one pass.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import link
from simmpp.engine.arrays.records import NONE, UNPACK, Row, Run
from simmpp.engine.arrays.views import copy_costs, messages, most_alive, pes, rays, rooms
from simmpp.engine.pe.bounds.credits import MANY, hear_credit, owe
from simmpp.engine.pe.costs import copy_ps, parts_ps
from simmpp.engine.pe.ready import make_ready
from simmpp.engine.pe.sending import forget
from simmpp.engine.record.counters import note_load, note_work
from simmpp.engine.record.log import note_unpack
from simmpp.machine.messages import RAYS
from simmpp.machine.transfer import transfer_ps


@kernel
def can_unpack(s: Run, me: int) -> bool:
    """Does a ray in a share fit?"""
    room = rooms(s)[me]
    row = room.first
    if row == NONE or room.reserved + room.smallest > room.queue_rays:
        return False
    smallest = MANY
    while row != NONE:
        ray = messages(s)[row].first
        while ray != NONE:
            if room.reserved + most_alive(s)[ray] <= room.queue_rays:
                return True
            smallest = min(smallest, most_alive(s)[ray])
            ray = rays(s)[ray].next
        row = messages(s)[row].next
    room.smallest = smallest
    return False


@kernel
def unpack(s: Run, me: int, now_ps: int) -> int:
    """Take in the rays that fit, at their cost per byte; returns the end of that."""
    pe, n = pes(s)[me], _admit(s, me, NONE)
    n_bytes = n * s.ray_bytes
    clock_ps = now_ps + transfer_ps(n_bytes, copy_costs(s)[UNPACK + RAYS].bytes_per_s)
    pe.received_load = 0
    if s.logs:
        note_unpack(s, me, n, n_bytes, now_ps, clock_ps)
    if s.record_counters:
        note_work(s, me, now_ps, clock_ps, clock_ps)
        note_load(s, me, clock_ps)
    pe.communication_ps += clock_ps - now_ps
    return clock_ps


@kernel
def taking_in_ps(s: Run, me: int, message: int) -> int:
    """Take in what has come and fits, older rays first; the cost of unpacking that.

    The fixed cost of a batch is paid now, its cost per byte when its rays are taken in.
    """
    m = messages(s)[message]
    hear_credit(s, me, m)
    if m.kind != RAYS:
        return parts_ps(s, message, UNPACK)
    rays(s)[m.last].next = NONE
    link(messages(s), rooms(s)[me], message)
    n = _admit(s, me, message)
    cost_ps = copy_ps(copy_costs(s)[UNPACK + RAYS], n * s.ray_bytes)
    return cost_ps + (parts_ps(s, m.part, UNPACK) if m.part != NONE else 0)


@kernel
def _admit(s: Run, me: int, message: int) -> int:
    """Make rays ready that fit; returns how many.

    Their messages are forgotten, but that which is being received.
    """
    room, pe = rooms(s)[me], pes(s)[me]
    row, head, tail, n = room.first, NONE, NONE, 0
    room.first, room.smallest = NONE, MANY
    while row != NONE:
        m, following, taken = messages(s)[row], messages(s)[row].next, 0
        if room.reserved < room.queue_rays:
            head, tail, taken = _take_fitting(s, room, m, head, tail)
        else:
            room.smallest = 1  # or more
        n += taken
        freed_bytes = taken * s.ray_bytes + (s.header_bytes if m.first == NONE else 0)
        if freed_bytes > 0:
            owe(s, me, m.source, freed_bytes)
            room.unread -= freed_bytes
        if m.first != NONE:
            link(messages(s), room, row)
        elif row != message:
            forget(s, row)
        row = following
    if n > 0:
        make_ready(s, me, head, tail, n)
    pe.load += n
    pe.peak_rays = max(pe.peak_rays, pe.load)
    return n


@kernel
def _take_fitting(s: Run, room: Row, m: Row, head: int, tail: int) -> tuple[int, int, int]:
    """Move rays that fit from a message to the list head ... tail; returns its ends, how many."""
    ray, before, n = m.first, NONE, 0
    while ray != NONE:
        following, most = rays(s)[ray].next, most_alive(s)[ray]
        if room.reserved + most <= room.queue_rays:
            room.reserved += most
            n += 1
            if before == NONE:
                m.first = following
            else:
                rays(s)[before].next = following
            if head == NONE:
                head = ray
            else:
                rays(s)[tail].next = ray
            tail = ray
        else:
            room.smallest = min(room.smallest, most)
            before = ray
        ray = following
    return head, tail, n
