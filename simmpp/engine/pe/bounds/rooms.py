"""What a PE holds, where its memory ends: room for rays, and the most that it ever held.

A ray that is started, or taken in, reserves room for all rays that may be alive at once of its
tree; a finished one leaves its room to its children. So a child always has room.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import NONE, Run
from simmpp.engine.arrays.views import messages, most_alive, pes, pixels, rays, rooms
from simmpp.machine.messages import RAYS, REQUEST

SENDS, RECEIVES, ASKS = range(3)
"""What credit or room may refuse: bits of ROOM.refused, numbers of ROOM.since_ps."""


@kernel
def fits(s: Run, me: int, ray: int) -> bool:
    """Is there room for all that may come of a ray?"""
    room = rooms(s)[me]
    return room.reserved + most_alive(s)[ray] <= room.queue_rays


@kernel
def has_ready(s: Run, me: int) -> bool:
    """Is there a ray to compute: one that is ready, or a pixel that fits?"""
    pe = pes(s)[me]
    if s.bounded == 0 or pe.first != NONE:
        return pe.n_ready > 0
    return pe.pixel < pe.pixel_end and fits(s, me, pixels(s)[pe.pixel])


@kernel
def release_rays(s: Run, me: int, first: int, n: int) -> None:
    """Linked rays leave: their room is free."""
    ray = first
    for _ in range(n):
        rooms(s)[me].reserved -= most_alive(s)[ray]
        ray = rays(s)[ray].next


@kernel
def rays_held(s: Run, me: int) -> int:
    """Rays that those started and taken in may become; without credits, these."""
    pe = pes(s)[me]
    return rooms(s)[me].reserved if s.bounded else pe.load - (pe.pixel_end - pe.pixel)


@kernel
def note_memory(s: Run, me: int) -> None:
    """Is what a PE holds more than ever before?"""
    room, n_rays = rooms(s)[me], rays_held(s, me)
    total = room.resident + room.fetched + n_rays * s.ray_bytes + room.unread
    if total > room.peak:
        room.peak, room.peak_fetched = total, room.fetched
        room.peak_queue, room.peak_receive = n_rays * s.ray_bytes, room.unread


@kernel
def note_arrival_of(s: Run, message: int) -> None:
    """What a message brings lies in the memory of its destination."""
    m = messages(s)[message]
    room = rooms(s)[m.destination]
    if m.kind == RAYS:
        room.unread += s.header_bytes + m.n * s.ray_bytes
        note_memory(s, m.destination)
    room.control += _control_bytes(s, message)
    room.peak_control = max(room.peak_control, room.control)


@kernel
def note_receipt(s: Run, me: int, message: int) -> None:
    """It is read; with credits, rays stay in the share of their sender until there is room."""
    m, room = messages(s)[message], rooms(s)[me]
    if m.kind == RAYS and not s.bounded:
        room.unread -= s.header_bytes + m.n * s.ray_bytes
    room.control -= _control_bytes(s, message)


@kernel
def _control_bytes(s: Run, message: int) -> int:
    """Requests of a message, and its header unless rays ride with them."""
    n_bytes = 0 if messages(s)[message].kind == RAYS else s.header_bytes
    part = message
    while part != NONE:
        if messages(s)[part].kind == REQUEST:
            n_bytes += s.request_bytes
        part = messages(s)[part].part
    return n_bytes


@kernel
def refuse(s: Run, me: int, what: int) -> None:
    """Credit or room refuses in this dispatch what a rule would do."""
    rooms(s)[me].refused |= 1 << what


@kernel
def note_stalls(s: Run, me: int, now_ps: int) -> None:
    """A dispatch has begun then and is over: what was refused in it, and what is no longer."""
    room = rooms(s)[me]
    if room.first != NONE:
        room.refused |= 1 << RECEIVES
    if room.refused != room.stalled:
        for what in range(3):
            is_refused, was_refused = room.refused >> what & 1, room.stalled >> what & 1
            if is_refused and not was_refused:
                room.since_ps[what] = now_ps
            elif was_refused and not is_refused:
                room.stalled_ps[what] += now_ps - room.since_ps[what]
        room.stalled = room.refused
    room.refused = 0
