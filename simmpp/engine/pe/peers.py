"""What a PE knows of the others: a row for each that it had to do with."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import add, append, find
from simmpp.engine.arrays.records import (
    BY_NIC,
    EXACT,
    NO_INFO,
    NONE,
    PIGGYBACK,
    SAMPLED,
    TWO,
    Row,
    Run,
)
from simmpp.engine.arrays.views import exchanged, peer_rows, peers, pes, told_loads
from simmpp.machine.messages import LOAD, OBJECT, RAYS


@kernel
def peer_of(s: Run, me: int, other: int) -> int:
    """The row of what PE ``me`` knows of PE ``other``."""
    key = me * s.processors + other
    peer_row = find(peers(s), key)
    if peer_row == NONE:
        peer_row = add(peers(s), key)
        peer_rows(s)[peer_row].load = NONE  # the rest is 0: rows of peers are never given back
    return peer_row


@kernel
def known_load(s: Run, peer_row: int) -> int:
    """What a PE knows of the load of another; NONE: nothing (load_info none)."""
    peer = peer_rows(s)[peer_row]
    if s.load_info == PIGGYBACK:
        return s.initial_load if peer.load == NONE else peer.load
    return load_shown(s, peer.key % s.processors)


@kernel
def load_shown(s: Run, other: int) -> int:
    """The same where it is not told in headers."""
    if s.load_info == NO_INFO:
        return NONE
    if s.load_info == SAMPLED:
        return pes(s)[other].sampled_load
    return pes(s)[other].settled_load


@kernel
def age_ps(s: Run, peer_row: int, now_ps: int) -> int:
    """How old that is; since the start if never heard."""
    peer = peer_rows(s)[peer_row]
    if s.load_info == EXACT or s.load_info == TWO:
        return 0
    if s.load_info == SAMPLED:
        return now_ps - s.sampled_ps
    return now_ps if s.load_info == NO_INFO or peer.load == NONE else now_ps - peer.heard_ps


@kernel
def sample_loads(s: Run, now_ps: int) -> None:
    """All PEs are shown the loads of now, until the next multiple of the period has passed."""
    for other in range(s.processors):
        pes(s)[other].sampled_load = pes(s)[other].settled_load
    s.sampled_ps = now_ps
    s.next_sample_ps = (now_ps // s.sample_ps + 1) * s.sample_ps


@kernel
def note_exchange(s: Run, me: int, peer_row: int) -> None:
    """Rays or objects went from one to the other: loads are refreshed between them."""
    if peer_rows(s)[peer_row].exchanged == 0:
        peer_rows(s)[peer_row].exchanged = 1
        append(exchanged(s), me, peer_row)


@kernel
def hear_load(s: Run, me: int, m: Row, now_ps: int) -> None:
    """Remember the load in a header, and whom rays or objects came from."""
    peer_row = peer_of(s, me, m.source)
    # What was got without its owner does not tell the load.
    if s.service != BY_NIC or m.kind != OBJECT:
        peer_rows(s)[peer_row].load = m.load
        peer_rows(s)[peer_row].heard_ps = now_ps
        peer_rows(s)[peer_row].in_flight = 0
        if s.steals:
            told_loads(s)[me * s.island + pes(s)[m.source].place] = m.load + 1
    if s.refresh_ps != NONE and m.kind in (OBJECT, RAYS):
        note_exchange(s, me, peer_row)


@kernel
def note_departure_to(s: Run, me: int, m: Row) -> None:
    """A message departs to another PE, which hears the load or, with nic, tells its own."""
    peer_row = peer_of(s, me, m.destination)
    peer = peer_rows(s)[peer_row]
    if s.service != BY_NIC or m.kind == LOAD:
        # What a thread sends may depart before what its PE has decided on already.
        peer.sent_ps = max(peer.sent_ps, m.depart_ps)
    if m.kind in (OBJECT, RAYS):
        note_exchange(s, me, peer_row)


@kernel
def silence_ps(s: Run, peer_row: int, now_ps: int) -> int:
    """For how long another PE has not been told the load; with nic: for how long that has not told
    its own, nor been asked for it."""
    peer = peer_rows(s)[peer_row]
    since_ps = max(peer.sent_ps, peer.heard_ps) if s.service == BY_NIC else peer.sent_ps
    return now_ps - since_ps
