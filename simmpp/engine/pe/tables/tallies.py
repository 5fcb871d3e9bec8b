"""Deposits: what tests leave in the results of objects, where these lie with the owners.

A PE collects deposits for each owner, and sends them in batches as it sends rays: when there are
enough, or nothing else is to do. A batch that is begun counts as a ray that is left, until the
owner has received it: so a run ends with its last deposit. It counts for the round of the ray that
has begun it.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import NONE, Row, Run
from simmpp.engine.arrays.views import (
    deposit_lists,
    deposit_rounds,
    deposits,
    messages,
    peer_rows,
    ray_rounds,
    rounds,
    sort_items,
)
from simmpp.engine.pe.candidates import relist
from simmpp.engine.pe.islands import owner_of
from simmpp.engine.pe.peers import peer_of
from simmpp.engine.pe.sending import new_part, send
from simmpp.engine.pe.tables.rounds import end_rounds
from simmpp.engine.pe.telling import collect_peers
from simmpp.machine.messages import DEPOSIT, DEPOSIT_BYTES


@kernel
def leave(s: Run, me: int, ray: int, obj: int) -> None:
    """A test of the ray has left something in the results of the object."""
    owner = owner_of(s, me, obj)
    if owner == me:
        return
    row = peer_of(s, me, owner)
    before = deposits(s)[row]
    if before == 0:
        s.rays_left += 1
        if s.n_rounds > 1:
            deposit_rounds(s)[row] = ray_rounds(s)[ray]
            rounds(s)[ray_rounds(s)[ray]].left += 1
    relist(deposit_lists(s), me, row, before, before + 1, s.deposits_from)
    deposits(s)[row] += 1


@kernel
def send_deposits(s: Run, me: int, nothing_else: int, now_ps: int) -> int:
    """Send batches that are large enough, or all; returns the end of that."""
    n = collect_peers(s, me, deposit_lists(s), 2 * me + 1, 0)
    if nothing_else:
        n = collect_peers(s, me, deposit_lists(s), 2 * me, n)
    clock_ps = now_ps
    for i in range(n):
        peer_row = sort_items(s)[i]
        count = deposits(s)[peer_row]
        row = new_part(s, DEPOSIT, peer_rows(s)[peer_row].key % s.processors, 0)
        m = messages(s)[row]
        m.payload_bytes = m.part_bytes = count * DEPOSIT_BYTES
        if s.n_rounds > 1:
            m.obj = deposit_rounds(s)[peer_row]
        relist(deposit_lists(s), me, peer_row, count, 0, s.deposits_from)
        deposits(s)[peer_row] = 0
        s.deposited += count
        clock_ps = send(s, me, row, clock_ps, False)
    return clock_ps


@kernel
def take_deposits(s: Run, m: Row, now_ps: int) -> None:
    """A batch has been received."""
    s.rays_left -= 1
    s.last_ray_ps = max(s.last_ray_ps, now_ps)
    if s.n_rounds > 1:
        its = rounds(s)[m.obj]
        its.left -= 1
        its.end_ps = max(its.end_ps, now_ps)
        end_rounds(s, NONE, now_ps)
