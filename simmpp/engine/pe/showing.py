"""What a hook of the policy is shown: the view's fields, of those that it reads."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.common.philox import philox
from simmpp.engine.arrays.records import NONE, Run
from simmpp.engine.arrays.views import (
    miss_rows,
    object_bytes,
    peer_rows,
    pes,
    policy_views,
    topology,
)
from simmpp.engine.network import flight_ps
from simmpp.engine.pe.costs import sent_alone_ps, taken_in_ps
from simmpp.engine.pe.islands import holders_of, owner_of
from simmpp.engine.pe.pace import speed_of, test_here_ps
from simmpp.engine.pe.peers import age_ps, known_load
from simmpp.engine.pe.wanted import fetch_ps, show_fetch, show_wanted
from simmpp.machine.messages import RAYS
from simmpp.machine.topology import hops
from simmpp.policy.view import DONE, LOADS, OBJECT, RANDOM, SELF, SPEEDS, WANTED, WAY, View


@kernel
def view_of(s: Run, me: int) -> View:
    """The view of a PE."""
    return policy_views(s)[me * s.remembers]


@kernel
def show_destination(s: Run, view: View, me: int, peer_row: int, now_ps: int) -> None:
    """Show ``send`` a PE that waiting rays may go to."""
    peer = peer_rows(s)[peer_row]
    other, waiting = peer.key - me * s.processors, peer.sendable
    view.load, view.other = pes(s)[me].load, other - pes(s)[me].base
    view.waiting, view.unasked = waiting, 0
    if s.send_reads & LOADS:
        show_load(s, view, peer_row, now_ps)
    if s.send_reads & ~LOADS == 0:
        return
    if s.send_reads & OBJECT:
        show_nothing(view)
    if s.send_reads & WAY:
        n_bytes = waiting * s.ray_bytes
        view.hops = hops(topology(s), me, other)
        view.send_ps = sent_alone_ps(s, me, other, RAYS, n_bytes)
        view.receive_ps, by_thread_ps = taken_in_ps(s, other, me, RAYS, n_bytes)
        view.flight_ps = flight_ps(s, me, other, n_bytes + s.header_bytes) + by_thread_ps
    if s.send_reads & WANTED:
        show_wanted(s, view, me, peer_row)
    show_self(s, view, me, now_ps, s.send_reads)


@kernel
def show_nothing(view: View) -> None:
    """There is no object that is asked about."""
    view.object, view.owner = NONE, NONE
    view.object_bytes = view.test_ps = view.holders = view.requests = 0


@kernel
def show_object(s: Run, view: View, me: int, miss_row: int, now_ps: int, reads: int) -> None:
    """Show ``ask`` an object that rays wait for, ``keep`` one that they have used."""
    miss = miss_rows(s)[miss_row]
    obj = miss.key - me * s.n_objects
    other = owner_of(s, me, obj)
    view.load, view.other = pes(s)[me].load, other - pes(s)[me].base
    view.waiting, view.unasked = miss.n, miss.unasked
    if reads == 0:
        return
    if reads & LOADS:
        show_load(s, view, miss.peer, now_ps)
    if reads & OBJECT:
        view.object, view.owner, view.requests = obj, view.other, miss.requests
        view.object_bytes, view.test_ps = object_bytes(s)[obj], test_here_ps(s, me, obj)
        first, end = holders_of(s, me, obj)
        view.holders = end - first
    if reads & WAY:
        view.hops = hops(topology(s), me, other)
        view.send_ps, view.receive_ps, view.flight_ps = fetch_ps(s, me, obj)
    if reads & WANTED:
        show_fetch(s, view, me, obj)
    show_self(s, view, me, now_ps, reads)


@kernel
def show_load(s: Run, view: View, peer_row: int, now_ps: int) -> None:
    """What this PE knows of the load of another, and how old that is."""
    view.in_flight = peer_rows(s)[peer_row].in_flight
    view.known_load, view.age_ps = known_load(s, peer_row), age_ps(s, peer_row, now_ps)


@kernel
def show_self(s: Run, view: View, me: int, now_ps: int, groups: int) -> None:
    """What a PE knows of itself, and what chance gives it."""
    pe = pes(s)[me]
    if groups & SELF:
        view.now_ps, view.me = now_ps, pe.place
        view.ready, view.held_bytes = pe.n_ready, pe.held_bytes
    if groups & DONE:
        view.finished, view.fetched, view.released = pe.finished, pe.fetched, pe.released
        view.busy_ps, view.compute_ps = pe.compute_ps + pe.communication_ps, pe.compute_ps
    if groups & SPEEDS:
        view.speed = speed_of(pe)
        view.other_speed = 0 if view.other == NONE else speed_of(pes(s)[pe.base + view.other])
    if groups & RANDOM:
        pe.draws += 1
        view.random = philox(s.random_key, me, pe.draws)
