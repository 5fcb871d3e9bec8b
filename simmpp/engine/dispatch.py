"""What a PE does with waiting rays at the end of an activity: its policy's two rules.

Sends come before asks; owners in the order me + 1, me + 2, ... (mod nb), objects by the ray that
has waited longest. The decisions cost nothing, the messages do.

Progress, whatever the rules say: rays go only to the owner of the object they need next, where it
is resident for good, and a fetched object is pinned for the rays that it makes ready. So every
transfer makes at least one test, and stale loads can herd rays but not bounce them.
"""

from __future__ import annotations

from typing import Any

from simmpp.compiled import njit
from simmpp.engine.sending import send
from simmpp.engine.state import EXACT, NO_INFO, PIGGYBACK, State
from simmpp.engine.tables import NONE, find, first, sort_by_key
from simmpp.engine.waiting import drop_if_idle, set_partner_sendable, set_unasked, withdraw
from simmpp.machine.messages import LOAD, RAYS, REQUEST
from simmpp.policy.rules import allows


@njit
def dispatch(s: State, me: int, inbox_empty: bool, now_ps: int) -> int:
    """Send and ask as the policy says; returns the end of the activity."""
    setup, pe = s.setup[0], s.pes[me]
    nothing_else = 1 if pe.n_ready == 0 and inbox_empty else 0
    clock_ps = now_ps
    if setup.sends:
        clock_ps = _send_rays(s, me, nothing_else, clock_ps)
    if setup.asks:
        clock_ps = _ask_for_objects(s, me, nothing_else, clock_ps)
    if setup.refresh_ps != NONE and pe.received_load == 0:
        clock_ps = _refresh_loads(s, me, clock_ps)
    pe.communication_ps += clock_ps - now_ps
    return clock_ps


@njit
def _send_rays(s: State, me: int, nothing_else: int, now_ps: int) -> int:
    setup, pe = s.setup[0], s.pes[me]
    n = _collect_owners(s, me, nothing_else)
    clock_ps = now_ps
    for i in range(n):
        row = s.scratch[1, i]
        partner = s.partners.rows[row]
        owner = partner.key % setup.processors
        known_load, age_ps = _known_load(s, partner, owner, clock_ps)
        waiting = partner.sendable
        seen = (pe.load, known_load, age_ps, waiting, nothing_else, setup.min_load)
        if allows(setup.may_send, seen):
            head, tail = _take_rays(s, me, row)
            pe.load -= waiting
            s.totals[0].rays_sent += waiting
            n_bytes = waiting * setup.ray_bytes
            clock_ps = send(s, me, owner, RAYS, NONE, head, tail, waiting, n_bytes, clock_ps)
    return clock_ps


@njit
def _collect_owners(s: State, me: int, nothing_else: int) -> int:
    """Partners that rays may be sent to, in ring order from me, into ``s.scratch[1]``."""
    n = 0
    nb = s.setup[0].processors
    for which in range(2 * me if nothing_else else 2 * me + 1, 2 * me + 2):
        row = first(s.unsent, which)
        while row >= 0:
            s.scratch[0, n] = (s.partners.rows[row].key % nb - me) % nb
            s.scratch[1, n] = row
            n += 1
            row = s.unsent.links[row, 1]
    sort_by_key(s.scratch[0], s.scratch[1], n)
    return n


@njit
def _known_load(s: State, partner: Any, owner: int, now_ps: int) -> tuple[int, int]:
    """What this PE knows of the owner's load, and how old that is."""
    setup = s.setup[0]
    if setup.load_info == NO_INFO:
        return NONE, now_ps
    if setup.load_info == EXACT:
        return s.pes[owner].settled_load, 0
    if partner.load == NONE:
        return setup.initial_load, now_ps
    return partner.load, now_ps - partner.heard_ps


@njit
def _take_rays(s: State, me: int, partner: int) -> tuple[int, int]:
    """Unfile all sendable rays of one owner: objects as they became sendable; first and last."""
    head, tail = NONE, NONE
    row = first(s.sendable, partner)
    while row >= 0:
        want, following = s.wants.rows[row], s.sendable.links[row, 1]
        if head == NONE:
            head = want.first
        else:
            s.rays[tail].next = want.first
        tail = want.last
        want.n = 0
        set_unasked(s, me, row, 0)
        drop_if_idle(s, row)
        row = following
    s.sendable.ends[partner, :] = 0
    set_partner_sendable(s, me, partner, 0)
    return head, tail


@njit
def _ask_for_objects(s: State, me: int, nothing_else: int, now_ps: int) -> int:
    setup, pe = s.setup[0], s.pes[me]
    n = _collect_wants(s, me, nothing_else)
    clock_ps = now_ps
    for i in range(n):
        row = s.scratch[1, i]
        want = s.wants.rows[row]
        if allows(setup.may_ask, (pe.load, want.unasked, nothing_else)):
            wanted = want.key % setup.n_objects
            requests = 1 if setup.merge_requests else want.unasked
            if want.requests == 0:
                withdraw(s, me, row)
            set_unasked(s, me, row, 0)
            want.requests += requests
            for _ in range(requests):
                owner, n_bytes = s.owners[wanted], setup.request_bytes
                clock_ps = send(s, me, owner, REQUEST, wanted, NONE, NONE, 0, n_bytes, clock_ps)
    return clock_ps


@njit
def _collect_wants(s: State, me: int, nothing_else: int) -> int:
    """Wants that may be asked for, longest waiting first, into ``s.scratch[1]``."""
    n = 0
    for which in range(2 * me if nothing_else else 2 * me + 1, 2 * me + 2):
        row = first(s.unasked, which)
        while row >= 0:
            s.scratch[0, n] = s.wants.rows[row].since
            s.scratch[1, n] = row
            n += 1
            row = s.unasked.links[row, 1]
    sort_by_key(s.scratch[0], s.scratch[1], n)
    return n


@njit
def _refresh_loads(s: State, me: int, now_ps: int) -> int:
    """Tell partners that have heard nothing for long my load (the cure of Nebel 1998, 4.2.2).

    Not after the receipt of such a message, or loads would answer loads for ever.
    """
    setup = s.setup[0]
    clock_ps = now_ps
    if setup.load_info != PIGGYBACK:
        return clock_ps
    for distance in range(1, setup.processors):
        other = (me + distance) % setup.processors
        row = find(s.partners, me * setup.processors + other)
        if row == NONE or not s.partners.rows[row].exchanged:
            continue
        if clock_ps - s.partners.rows[row].sent_ps >= setup.refresh_ps:
            clock_ps = send(s, me, other, LOAD, NONE, NONE, NONE, 0, 0, clock_ps)
    return clock_ps
