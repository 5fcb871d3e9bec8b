"""What a PE does with waiting rays at the end of an activity: its policy's hooks send and ask.

Sends come before asks; owners in the order me + 1, me + 2, ... (mod nb), objects by the ray that
has waited longest. The decisions cost nothing, the messages do: each is sent as soon as it is
decided on or, with packing, when all is decided (``send_made_up``).

An example, concurrent dataflow with batch 2 and ask_at_least 3: rays 4, 6 and 9 wait for object 20
of PE 3 and ray 5 for object 21 of PE 0; PE 1 decides, still has ready rays and holds 8 rays in all.

    send  PE 3: 3 rays wait, enough to ask send; 8 > min_load, 8 > 5 (heard of PE 3): a message
          RAYS takes 4, 6 and 9. The load is 5 when it is packed, and a hook asked next sees that.
          PE 0: 1 ray, not enough: send is asked only with nothing else to do.
    ask   Object 21: 1 ray, not enough. Had send kept 4, 6 and 9, object 20 would be asked for,
          and from then on its rays can't be sent until it is here.

Progress, whatever the hooks say: rays go only where the object that they need next is resident for
good, only a PE that has it for good is asked for it, and a fetched object is pinned
for the rays that it makes ready. So every transfer makes at least one test, and stale loads can
herd rays but not bounce them.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.common.philox import philox
from simmpp.engine.arrays.hashtable import first, following, sort_by_key
from simmpp.engine.arrays.records import NONE, SINGLY, TWO, Row, Run
from simmpp.engine.arrays.views import (
    miss_rows,
    peer_rows,
    pes,
    rays,
    sendable,
    sort_items,
    sort_keys,
    unasked,
    unsent,
)
from simmpp.engine.pe.bounds.admission import can_unpack
from simmpp.engine.pe.bounds.credits import enough_for, rays_allowed, spend
from simmpp.engine.pe.bounds.escape import escape
from simmpp.engine.pe.bounds.rooms import ASKS, SENDS, has_ready, note_stalls, refuse, release_rays
from simmpp.engine.pe.candidates import withdraw
from simmpp.engine.pe.fetched import reserve_object
from simmpp.engine.pe.islands import owner_of
from simmpp.engine.pe.misses import is_holder, set_unasked, unfile
from simmpp.engine.pe.peers import known_load
from simmpp.engine.pe.sending import send_made_up, send_rays, send_request
from simmpp.engine.pe.showing import show_destination, show_object, view_of
from simmpp.engine.pe.tables.tallies import send_deposits
from simmpp.engine.pe.telling import collect_peers, refresh_loads, return_credits
from simmpp.engine.record.counters import note_work
from simmpp.policy.record import consult
from simmpp.policy.view import View


@kernel
def dispatch(s: Run, me: int, inbox_empty: bool, now_ps: int) -> int:
    """Send and ask as the policy says; returns the end of the activity."""
    pe = pes(s)[me]
    # Once, before anything is sent: what a message takes away doesn't make the next one urgent.
    view = view_of(s, me)
    busy = has_ready(s, me) or (s.bounded and can_unpack(s, me))
    view.nothing_else = 1 if inbox_empty and not busy else 0
    clock_ps = now_ps
    if s.sends:
        clock_ps = _send_rays(s, me, view, clock_ps)
    if s.asks:
        clock_ps = _ask_for_objects(s, me, view, clock_ps)
    if s.escapes:
        clock_ps = escape(s, me, inbox_empty, clock_ps)
    if s.packing != SINGLY:
        clock_ps = send_made_up(s, me, clock_ps)
    if s.leaves_n > 0:
        clock_ps = send_deposits(s, me, view.nothing_else, clock_ps)
    if s.refresh_ps != NONE and pe.received_load == 0:
        clock_ps = refresh_loads(s, me, clock_ps)
    if s.bounded:
        clock_ps = return_credits(s, me, clock_ps)
        note_stalls(s, me, now_ps)
    if s.record_counters and clock_ps > now_ps:
        note_work(s, me, now_ps, clock_ps, clock_ps)
    pe.communication_ps += clock_ps - now_ps
    return clock_ps


@kernel
def _send_rays(s: Run, me: int, view: View, now_ps: int) -> int:
    pe = pes(s)[me]
    # Collected before the first message, as sending changes the lists.
    n = collect_peers(s, me, unsent(s), 2 * me + 1, 0)
    if view.nothing_else:
        n = collect_peers(s, me, unsent(s), 2 * me, n)
    clock_ps = now_ps
    if s.load_info == TWO and s.to_holders and n > 2:
        n = _keep_two(s, pe, me, n)
    if s.to_holders:
        _put_least_loaded_first(s, n)
    for i in range(n):
        peer_row = sort_items(s)[i]
        if s.to_holders and not _still_enough(s, view, peer_row):
            continue
        show_destination(s, view, me, peer_row, clock_ps)
        may_go = consult(s.send, view)
        if may_go > 0:
            head, tail, n_rays = _take_rays(s, me, peer_row, may_go)
            if n_rays == 0:  # there is no credit
                continue
            pe.load -= n_rays
            s.rays_sent += n_rays
            if s.listens:
                peer_rows(s)[peer_row].in_flight += n_rays
            other = peer_rows(s)[peer_row].key % s.processors
            clock_ps = send_rays(s, me, other, head, tail, n_rays, clock_ps)
    return clock_ps


@kernel
def _keep_two(s: Run, pe: Row, me: int, n: int) -> int:
    """Of n peers in ``sort_items`` two at random, in their order; returns 2."""
    one = philox(s.random_key, me, pe.draws + 1) % n
    other = philox(s.random_key, me, pe.draws + 2) % (n - 1)
    pe.draws += 2
    if other >= one:
        other += 1
    one, other = min(one, other), max(one, other)
    for at, chosen in ((0, one), (1, other)):
        sort_keys(s)[at], sort_items(s)[at] = sort_keys(s)[chosen], sort_items(s)[chosen]
    return 2


@kernel
def _put_least_loaded_first(s: Run, n: int) -> None:
    """Sort the first n peers of ``sort_items`` by known load, equal ones in ring order."""
    for i in range(n):
        sort_keys(s)[i] += (known_load(s, sort_items(s)[i]) + 1) * s.processors
    sort_by_key(sort_keys(s), sort_items(s), n)


@kernel
def _still_enough(s: Run, view: View, peer_row: int) -> bool:
    """Is ``send`` to be asked, after rays that could have gone here went elsewhere?"""
    n = peer_rows(s)[peer_row].sendable
    return n >= enough_for(s, peer_row) or (n > 0 and view.nothing_else == 1)


@kernel
def _take_rays(s: Run, me: int, peer_row: int, enough: int) -> tuple[int, int, int]:
    """Unfile rays that may go to a PE, of whole objects, until there are enough or none is left.

    Objects as they became sendable; where credit ends, only the oldest rays of one. Returns the
    first, the last and how many.
    """
    other = peer_rows(s)[peer_row].key % s.processors
    head, tail, n, most = NONE, NONE, 0, rays_allowed(s, peer_row)
    miss_row = first(sendable(s), me if s.to_holders else peer_row)
    while miss_row >= 0 and n < min(enough, most):
        # The successor is read first: the row may be given back.
        miss, successor = miss_rows(s)[miss_row], following(sendable(s), miss_row)
        if not s.to_holders or is_holder(s, other, miss.key % s.n_objects):
            if head == NONE:
                head = miss.first
            else:
                rays(s)[tail].next = miss.first
            taken, tail = min(miss.n, most - n), miss.last
            if taken < miss.n:
                tail = _nth(s, miss.first, taken)
            n += taken
            unfile(s, me, miss_row, taken)
        miss_row = successor
    if s.bounded:
        _pay_for_rays(s, me, peer_row, head, n, enough)
    return head, tail, n


@kernel
def _nth(s: Run, ray: int, n: int) -> int:
    """The n-th ray of a list, the first being 1."""
    for _ in range(n - 1):
        ray = rays(s)[ray].next
    return ray


@kernel
def _pay_for_rays(s: Run, me: int, peer_row: int, head: int, n: int, enough: int) -> None:
    """Rays leave, which takes credit and frees room; perhaps credit has kept others."""
    release_rays(s, me, head, n)
    if n > 0:
        spend(s, peer_row, n)
    if n < enough and peer_rows(s)[peer_row].sendable > 0:
        refuse(s, me, SENDS)


@kernel
def _ask_for_objects(s: Run, me: int, view: View, now_ps: int) -> int:
    n = _collect_misses(s, me, view.nothing_else)
    clock_ps = now_ps
    for i in range(n):
        miss_row = sort_items(s)[i]
        show_object(s, view, me, miss_row, clock_ps, s.ask_reads)
        answer = consult(s.ask, view)
        if answer > 0:
            if s.measures and not reserve_object(s, me, miss_row):
                refuse(s, me, ASKS)
                continue
            miss = miss_rows(s)[miss_row]
            obj = miss.key % s.n_objects
            other = _who_has(s, me, obj, answer - 2)
            requests = 1 if s.merge_requests else miss.unasked
            if miss.requests == 0:
                withdraw(s, me, miss_row)
            set_unasked(s, me, miss_row, 0)
            miss.requests += requests
            for _ in range(requests):
                clock_ps = send_request(s, me, other, obj, clock_ps)
    return clock_ps


@kernel
def _who_has(s: Run, me: int, obj: int, chosen: int) -> int:
    """The PE of its island that the policy has chosen, if it has the object; else the owner."""
    other = pes(s)[me].base + chosen
    if 0 <= chosen < s.island and is_holder(s, other, obj):
        return other
    return owner_of(s, me, obj)


@kernel
def _collect_misses(s: Run, me: int, nothing_else: int) -> int:
    """Misses that may be asked for, longest waiting first, into ``sort_items``."""
    n = 0
    for which in range(2 * me if nothing_else else 2 * me + 1, 2 * me + 2):
        row = first(unasked(s), which)
        while row >= 0:
            sort_keys(s)[n] = miss_rows(s)[row].since
            sort_items(s)[n] = row
            n += 1
            row = following(unasked(s), row)
    sort_by_key(sort_keys(s), sort_items(s), n)
    return n
