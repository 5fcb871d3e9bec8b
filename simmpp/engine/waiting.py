"""Rays that wait for an object which their PE lacks, and the objects it holds for a while."""

from __future__ import annotations

from simmpp.compiled import njit
from simmpp.engine.ready import make_ready
from simmpp.engine.state import State
from simmpp.engine.tables import NONE, Lists, add, append, find, first, remove, unlink


@njit
def is_in_memory(s: State, me: int, wanted: int) -> bool:
    """Is the object resident, or in transient memory?"""
    if s.owners[wanted] == me or s.setup[0].all_resident:
        return True
    if s.resident.size and s.resident[me, wanted >> 3] >> (wanted & 7) & 1:
        return True
    if s.setup[0].transient == 0:
        return False
    want = find(s.wants, me * s.setup[0].n_objects + wanted)
    return want != NONE and s.wants.rows[want].transient == 1


@njit
def partner_of(s: State, me: int, other: int) -> int:
    """The row of what PE ``me`` knows of PE ``other``."""
    key = me * s.setup[0].processors + other
    row = find(s.partners, key)
    if row == NONE:
        row = add(s.partners, key)
        partner = s.partners.rows[row]
        partner.load = NONE
        partner.heard_ps = 0
        partner.sent_ps = 0
        partner.sendable = 0
        partner.exchanged = 0
    return row


@njit
def file_ray(s: State, me: int, ray: int, wanted: int) -> None:
    """A ray begins to wait, filed under (object, owner)."""
    row = _want(s, me, wanted)
    want = s.wants.rows[row]
    s.rays[ray].next = NONE
    if want.n == 0:
        want.first = ray
    else:
        s.rays[want.last].next = ray
    want.last = ray
    want.n += 1
    pe = s.pes[me]
    pe.waits += 1
    if want.requests == 0:
        _set_sendable(s, me, row, 1)
    if want.requests == 0 or not s.setup[0].merge_requests:
        if want.unasked == 0:
            want.since = pe.waits
        set_unasked(s, me, row, want.unasked + 1)


@njit
def _want(s: State, me: int, wanted: int) -> int:
    """The row of an object that PE ``me`` lacks or holds for a while."""
    key = me * s.setup[0].n_objects + wanted
    row = find(s.wants, key)
    if row == NONE:
        row = add(s.wants, key)
        want = s.wants.rows[row]
        want.n = 0
        want.unasked = 0
        want.requests = 0
        want.pinned = 0
        want.transient = 0
        if s.setup[0].sends:
            want.partner = partner_of(s, me, s.owners[wanted])
    return row


@njit
def drop_if_idle(s: State, row: int) -> None:
    """Forget an object that nobody waits for and nobody holds."""
    want = s.wants.rows[row]
    if want.n == 0 and want.requests == 0 and want.pinned == 0 and want.transient == 0:
        remove(s.wants, row)


@njit
def set_unasked(s: State, me: int, row: int, n: int) -> None:
    """Change the number of rays that no request covers, and the list that shows it."""
    want = s.wants.rows[row]
    if s.setup[0].asks:
        enough = s.setup[0].ask_at_least
        _move(s.unasked, me, row, want.unasked, n, enough)
    want.unasked = n


@njit
def _set_sendable(s: State, me: int, row: int, added: int) -> None:
    """Waiting rays of an object become sendable; all of its rays before were, or none."""
    if not s.setup[0].sends:
        return
    want = s.wants.rows[row]
    if want.n == added:
        append(s.sendable, want.partner, row)
    partner = s.partners.rows[want.partner]
    set_partner_sendable(s, me, want.partner, partner.sendable + added)


@njit
def withdraw(s: State, me: int, row: int) -> None:
    """An object has been asked for: its waiting rays can't be sent any more."""
    if not s.setup[0].sends:
        return
    want = s.wants.rows[row]
    unlink(s.sendable, want.partner, row)
    partner = s.partners.rows[want.partner]
    set_partner_sendable(s, me, want.partner, partner.sendable - want.n)


@njit
def set_partner_sendable(s: State, me: int, row: int, n: int) -> None:
    """Change the number of rays that may be sent to an owner, and the list that shows it."""
    partner = s.partners.rows[row]
    _move(s.unsent, me, row, partner.sendable, n, s.setup[0].batch)
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


@njit
def admit_object(s: State, me: int, arrived: int) -> None:
    """A fetched object has arrived: rays that wait for it are released for one test each."""
    row = find(s.wants, me * s.setup[0].n_objects + arrived)
    want = s.wants.rows[row]
    want.requests -= 1
    if want.pinned == 0 and want.transient == 0:
        s.pes[me].held_bytes += s.object_bytes[arrived]
    _release(s, me, row)
    if want.requests == 0 and want.n > 0:
        _set_sendable(s, me, row, want.n)
    if s.setup[0].transient > 0:
        _keep(s, me, row)
    elif want.pinned == 0:
        s.pes[me].held_bytes -= s.object_bytes[arrived]
    drop_if_idle(s, row)


@njit
def _release(s: State, me: int, row: int) -> None:
    """Grant the waiting rays (one, if requests are not merged) their next test."""
    want = s.wants.rows[row]
    if want.n == 0:
        return
    n = want.n if s.setup[0].merge_requests else 1
    head = want.first
    tail = head
    s.rays[tail].granted = 1
    for _ in range(n - 1):
        tail = s.rays[tail].next
        s.rays[tail].granted = 1
    want.first = s.rays[tail].next
    want.n -= n
    want.pinned += n
    make_ready(s, me, head, tail, n)


@njit
def _keep(s: State, me: int, row: int) -> None:
    """Put a fetched object into transient memory; the least recently used one may have to go."""
    pe, want = s.pes[me], s.wants.rows[row]
    if want.transient == 1:
        touch(s, me, row)
        return
    want.transient = 1
    append(s.recent, me, row)
    pe.n_transient += 1
    if pe.n_transient > s.setup[0].transient:
        oldest = first(s.recent, me)
        evicted = s.wants.rows[oldest]
        unlink(s.recent, me, oldest)
        evicted.transient = 0
        pe.n_transient -= 1
        if evicted.pinned == 0:
            pe.held_bytes -= s.object_bytes[evicted.key % s.setup[0].n_objects]
        drop_if_idle(s, oldest)


@njit
def touch(s: State, me: int, row: int) -> None:
    """An object in transient memory is used: it becomes the most recent one."""
    if s.wants.rows[row].transient == 1:
        unlink(s.recent, me, row)
        append(s.recent, me, row)


@njit
def unpin(s: State, me: int, row: int, tested: int) -> None:
    """A released ray has made the test that the object was pinned for."""
    want = s.wants.rows[row]
    want.pinned -= 1
    if want.pinned == 0 and want.transient == 0:
        s.pes[me].held_bytes -= s.object_bytes[tested]
    drop_if_idle(s, row)
