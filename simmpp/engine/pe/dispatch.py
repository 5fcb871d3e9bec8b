"""What a PE does with waiting rays at the end of an activity: its policy's two rules.

Sends come before asks; owners in the order me + 1, me + 2, ... (mod nb), objects by the ray that
has waited longest. The decisions cost nothing, the messages do.

Progress, whatever the rules say: rays go only to the owner of the object they need next, where it
is resident for good, and a fetched object is pinned for the rays that it makes ready. So every
transfer makes at least one test, and stale loads can herd rays but not bounce them.
"""

from __future__ import annotations

from simmpp.common.compiled import njit_reading as njit
from simmpp.engine.arrays.hashtable import Lists, clear, first, following, sort_by_key
from simmpp.engine.arrays.layout import EXACT, NO_INFO, NONE, Row, Run
from simmpp.engine.arrays.views import (
    exchanged,
    owners,
    partner_rows,
    pes,
    rays,
    sendable,
    sort_items,
    sort_keys,
    unasked,
    unsent,
    want_rows,
)
from simmpp.engine.pe.misses import drop_if_idle, set_partner_sendable, set_unasked, withdraw
from simmpp.engine.pe.sending import send
from simmpp.engine.record.counters import note_work
from simmpp.machine.messages import LOAD, RAYS, REQUEST
from simmpp.policy.rules import allows


@njit
def dispatch(s: Run, me: int, inbox_empty: bool, now_ps: int) -> int:
    """Send and ask as the policy says; returns the end of the activity."""
    pe = pes(s)[me]
    nothing_else = 1 if pe.n_ready == 0 and inbox_empty else 0
    clock_ps = now_ps
    if s.sends:
        clock_ps = _send_rays(s, me, nothing_else, clock_ps)
    if s.asks:
        clock_ps = _ask_for_objects(s, me, nothing_else, clock_ps)
    if s.refresh_ps != NONE and pe.received_load == 0:
        clock_ps = _refresh_loads(s, me, clock_ps)
    if s.record_counters and clock_ps > now_ps:
        note_work(s, me, now_ps, clock_ps, clock_ps)
    pe.communication_ps += clock_ps - now_ps
    return clock_ps


@njit
def _send_rays(s: Run, me: int, nothing_else: int, now_ps: int) -> int:
    pe = pes(s)[me]
    n = _collect_owners(s, me, nothing_else)
    clock_ps = now_ps
    for i in range(n):
        row = sort_items(s)[i]
        partner = partner_rows(s)[row]
        owner = partner.key % s.processors
        known_load, age_ps = _known_load(s, partner, owner, clock_ps)
        waiting = partner.sendable
        seen = (pe.load, known_load, age_ps, waiting, nothing_else, s.min_load)
        if allows(s.may_send, seen):
            head, tail = _take_rays(s, me, row)
            pe.load -= waiting
            s.rays_sent += waiting
            n_bytes = waiting * s.ray_bytes
            clock_ps = send(s, me, owner, RAYS, NONE, head, tail, waiting, n_bytes, clock_ps)
    return clock_ps


@njit
def _collect_owners(s: Run, me: int, nothing_else: int) -> int:
    """Partners that rays may be sent to, in ring order from me, into ``sort_items``."""
    n = _collect_partners(s, me, unsent(s), 2 * me + 1, 0)
    return _collect_partners(s, me, unsent(s), 2 * me, n) if nothing_else else n


@njit
def _collect_partners(s: Run, me: int, lists: Lists, which: int, n: int) -> int:
    """Add the partners of one list to the first n of ``sort_items``, in ring order from me."""
    nb = s.processors
    row = first(lists, which)
    while row >= 0:
        sort_keys(s)[n] = (partner_rows(s)[row].key % nb - me) % nb
        sort_items(s)[n] = row
        n += 1
        row = following(lists, row)
    sort_by_key(sort_keys(s), sort_items(s), n)
    return n


@njit
def _known_load(s: Run, partner: Row, owner: int, now_ps: int) -> tuple[int, int]:
    """What this PE knows of the owner's load, and how old that is."""
    if s.load_info == NO_INFO:
        return NONE, now_ps
    if s.load_info == EXACT:
        return pes(s)[owner].settled_load, 0
    if partner.load == NONE:
        return s.initial_load, now_ps
    return partner.load, now_ps - partner.heard_ps


@njit
def _take_rays(s: Run, me: int, partner: int) -> tuple[int, int]:
    """Unfile all sendable rays of one owner: objects as they became sendable; first and last."""
    head, tail = NONE, NONE
    row = first(sendable(s), partner)
    while row >= 0:
        want, successor = want_rows(s)[row], following(sendable(s), row)
        if head == NONE:
            head = want.first
        else:
            rays(s)[tail].next = want.first
        tail = want.last
        want.n = 0
        set_unasked(s, me, row, 0)
        drop_if_idle(s, row)
        row = successor
    clear(sendable(s), partner)
    set_partner_sendable(s, me, partner, 0)
    return head, tail


@njit
def _ask_for_objects(s: Run, me: int, nothing_else: int, now_ps: int) -> int:
    pe = pes(s)[me]
    n = _collect_wants(s, me, nothing_else)
    clock_ps = now_ps
    for i in range(n):
        row = sort_items(s)[i]
        want = want_rows(s)[row]
        if allows(s.may_ask, (pe.load, want.unasked, nothing_else)):
            wanted = want.key % s.n_objects
            requests = 1 if s.merge_requests else want.unasked
            if want.requests == 0:
                withdraw(s, me, row)
            set_unasked(s, me, row, 0)
            want.requests += requests
            for _ in range(requests):
                owner, n_bytes = owners(s)[wanted], s.request_bytes
                clock_ps = send(s, me, owner, REQUEST, wanted, NONE, NONE, 0, n_bytes, clock_ps)
    return clock_ps


@njit
def _collect_wants(s: Run, me: int, nothing_else: int) -> int:
    """Wants that may be asked for, longest waiting first, into ``sort_items``."""
    n = 0
    for which in range(2 * me if nothing_else else 2 * me + 1, 2 * me + 2):
        row = first(unasked(s), which)
        while row >= 0:
            sort_keys(s)[n] = want_rows(s)[row].since
            sort_items(s)[n] = row
            n += 1
            row = following(unasked(s), row)
    sort_by_key(sort_keys(s), sort_items(s), n)
    return n


@njit
def _refresh_loads(s: Run, me: int, now_ps: int) -> int:
    """Tell partners that have heard nothing for long my load (the cure of Nebel 1998, 4.2.2).

    Not after the receipt of such a message, or loads would answer loads for ever.
    """
    clock_ps = now_ps
    for i in range(_collect_partners(s, me, exchanged(s), me, 0)):
        partner = partner_rows(s)[sort_items(s)[i]]
        if clock_ps - partner.sent_ps >= s.refresh_ps:
            other = partner.key % s.processors
            clock_ps = send(s, me, other, LOAD, NONE, NONE, NONE, 0, 0, clock_ps)
    return clock_ps
