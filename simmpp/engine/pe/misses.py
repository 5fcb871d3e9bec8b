"""Rays that wait for an object which their PE lacks, and the objects it holds for a while."""

from __future__ import annotations

from simmpp.common.compiled import njit_reading as njit
from simmpp.engine.arrays.hashtable import Lists, add, append, find, remove, unlink
from simmpp.engine.arrays.layout import NONE, Run
from simmpp.engine.arrays.views import (
    exchanged,
    owners,
    partner_rows,
    partners,
    pes,
    rays,
    replica_objects,
    replica_offsets,
    resident,
    sendable,
    unasked,
    unsent,
    want_rows,
    wants,
)
from simmpp.machine.torus import hops


@njit
def is_in_memory(s: Run, me: int, wanted: int) -> bool:
    """Is the object resident, or in transient memory?"""
    if owners(s)[wanted] == me or s.all_resident:
        return True
    if _is_replica(s, me, wanted):
        return True
    if s.transient == 0:
        return False
    want = find(wants(s), me * s.n_objects + wanted)
    return want != NONE and want_rows(s)[want].transient == 1


@njit
def _is_replica(s: Run, me: int, wanted: int) -> bool:
    """Does the PE hold a replica of the object for good?"""
    if s.row_bytes > 0:
        return resident(s)[me * s.row_bytes + (wanted >> 3)] >> (wanted & 7) & 1 == 1
    if s.replica_objects_n == 0:
        return False
    low, high = replica_offsets(s)[me], replica_offsets(s)[me + 1]
    end = high
    while low < high:
        middle = (low + high) // 2
        if replica_objects(s)[middle] < wanted:
            low = middle + 1
        else:
            high = middle
    return low < end and replica_objects(s)[low] == wanted


@njit
def note_exchange(s: Run, me: int, partner: int) -> None:
    """Rays or objects went from one to the other: loads are refreshed between them."""
    if partner_rows(s)[partner].exchanged == 0:
        partner_rows(s)[partner].exchanged = 1
        append(exchanged(s), me, partner)


@njit
def partner_of(s: Run, me: int, other: int) -> int:
    """The row of what PE ``me`` knows of PE ``other``."""
    key = me * s.processors + other
    row = find(partners(s), key)
    if row == NONE:
        row = add(partners(s), key)
        partner = partner_rows(s)[row]
        partner.load = NONE
        partner.heard_ps = 0
        partner.sent_ps = 0
        partner.sendable = 0
        partner.exchanged = 0
    return row


@njit
def file_ray(s: Run, me: int, ray: int, wanted: int) -> None:
    """A ray begins to wait, filed under (object, owner).

    Whether it will be sent or the object fetched, something has to go to the owner for it.
    """
    row = _want(s, me, wanted)
    want = want_rows(s)[row]
    rays(s)[ray].next = NONE
    rays(s)[ray].hops += want.hops
    if want.n == 0:
        want.first = ray
    else:
        rays(s)[want.last].next = ray
    want.last = ray
    want.n += 1
    pe = pes(s)[me]
    pe.waits += 1
    if want.requests == 0:
        set_sendable(s, me, row, 1)
    if want.requests == 0 or not s.merge_requests:
        if want.unasked == 0:
            want.since = pe.waits
        set_unasked(s, me, row, want.unasked + 1)


@njit
def _want(s: Run, me: int, wanted: int) -> int:
    """The row of an object that PE ``me`` lacks or holds for a while."""
    key = me * s.n_objects + wanted
    row = find(wants(s), key)
    if row == NONE:
        row = add(wants(s), key)
        want = want_rows(s)[row]
        want.n = 0
        want.unasked = 0
        want.requests = 0
        want.pinned = 0
        want.transient = 0
        want.hops = hops(s.x, s.y, s.z, me, owners(s)[wanted]) if s.record_hops else 0
        if s.sends:
            want.partner = partner_of(s, me, owners(s)[wanted])
    return row


@njit
def drop_if_idle(s: Run, row: int) -> None:
    """Forget an object that nobody waits for and nobody holds."""
    want = want_rows(s)[row]
    if want.n == 0 and want.requests == 0 and want.pinned == 0 and want.transient == 0:
        remove(wants(s), row)


@njit
def set_unasked(s: Run, me: int, row: int, n: int) -> None:
    """Change the number of rays that no request covers, and the list that shows it."""
    want = want_rows(s)[row]
    if s.asks:
        enough = s.ask_at_least
        _move(unasked(s), me, row, want.unasked, n, enough)
    want.unasked = n


@njit
def set_sendable(s: Run, me: int, row: int, added: int) -> None:
    """Waiting rays of an object become sendable; all of its rays before were, or none."""
    if not s.sends:
        return
    want = want_rows(s)[row]
    if want.n == added:
        append(sendable(s), want.partner, row)
    partner = partner_rows(s)[want.partner]
    set_partner_sendable(s, me, want.partner, partner.sendable + added)


@njit
def withdraw(s: Run, me: int, row: int) -> None:
    """An object has been asked for: its waiting rays can't be sent any more."""
    if not s.sends:
        return
    want = want_rows(s)[row]
    unlink(sendable(s), want.partner, row)
    partner = partner_rows(s)[want.partner]
    set_partner_sendable(s, me, want.partner, partner.sendable - want.n)


@njit
def set_partner_sendable(s: Run, me: int, row: int, n: int) -> None:
    """Change the number of rays that may be sent to an owner, and the list that shows it."""
    partner = partner_rows(s)[row]
    _move(unsent(s), me, row, partner.sendable, n, s.batch)
    partner.sendable = n


@njit
def _move(lists: Lists, me: int, row: int, before: int, after: int, enough: int) -> None:
    """Keep ``row`` in the PE's list of those with some rays (2 me) or enough (2 me + 1)."""
    if before > 0 and after > 0 and (before >= enough) == (after >= enough):
        return
    if before > 0:
        unlink(lists, 2 * me + (1 if before >= enough else 0), row)
    if after > 0:
        append(lists, 2 * me + (1 if after >= enough else 0), row)
