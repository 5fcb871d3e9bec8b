"""What it would take to fetch objects: shown to hooks, paid by nobody."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import first, following
from simmpp.engine.arrays.records import BY_NIC, Run
from simmpp.engine.arrays.views import (
    miss_rows,
    object_bytes,
    peer_rows,
    sendable,
)
from simmpp.engine.network import flight_ps
from simmpp.engine.pe.costs import received_alone_ps, sent_alone_ps, taken_in_ps
from simmpp.engine.pe.islands import owner_of
from simmpp.engine.pe.misses import is_holder
from simmpp.machine.messages import OBJECT, REQUEST
from simmpp.policy.view import View


@kernel
def fetch_ps(s: Run, me: int, obj: int) -> tuple[int, int, int]:
    """What sending the request costs, what receiving the object, and the time in between."""
    asked, owner, n_bytes = s.request_bytes, owner_of(s, me, obj), object_bytes(s)[obj]
    send_ps = sent_alone_ps(s, me, owner, REQUEST, asked)
    receive_ps, between_ps = taken_in_ps(s, me, owner, OBJECT, n_bytes)
    between_ps += flight_ps(s, me, owner, asked + s.header_bytes)
    between_ps += flight_ps(s, owner, me, n_bytes + s.header_bytes)
    if s.service != BY_NIC:
        between_ps += received_alone_ps(s, owner, me, REQUEST, asked)
        between_ps += sent_alone_ps(s, owner, me, OBJECT, n_bytes)
    return send_ps, receive_ps, between_ps


@kernel
def show_fetch(s: Run, view: View, me: int, obj: int) -> None:
    """Show one object as all that is wanted."""
    send_ps, receive_ps, between_ps = fetch_ps(s, me, obj)
    view.objects, view.fetch_ps, view.fetch_flight_ps = 1, send_ps + receive_ps, between_ps


@kernel
def show_wanted(s: Run, view: View, me: int, peer_row: int) -> None:
    """Show the objects that rays wait for which may go to a PE."""
    other = peer_rows(s)[peer_row].key % s.processors
    view.objects = view.fetch_ps = view.fetch_flight_ps = 0
    row = first(sendable(s), me if s.to_holders else peer_row)
    while row >= 0:
        obj = miss_rows(s)[row].key % s.n_objects
        if not s.to_holders or is_holder(s, other, obj):
            send_ps, receive_ps, between_ps = fetch_ps(s, me, obj)
            view.objects += 1
            view.fetch_ps += send_ps + receive_ps
            view.fetch_flight_ps += between_ps
        row = following(sendable(s), row)
