"""Messages: made up of parts, packed, and let go.

A message is one part, or several that share its startups and its header: rays, then objects, then
requests. Without packing whatever a dispatch decides on is a message of its own and departs at
once. With it the dispatch only makes messages up, one for each PE, and they are packed when all is
decided. Each function returns the moment when what it sent has been packed.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.hashtable import give_back, sort_by_key, take
from simmpp.engine.arrays.records import (
    BY_NIC,
    ITS_LOAD,
    NONE,
    ORDINARY,
    PACK,
    REQUESTS_TOGETHER,
    SINGLY,
    Row,
    Run,
)
from simmpp.engine.arrays.views import (
    made_up,
    message_marks,
    messages,
    object_bytes,
    outbox,
    parts_by_kind,
    pes,
    sent_by_kind,
    sort_items,
    sort_keys,
    user_words,
)
from simmpp.engine.network import depart
from simmpp.engine.pe.bounds.credits import take_owed
from simmpp.engine.pe.costs import parts_ps, sending_ps
from simmpp.engine.pe.peers import note_departure_to
from simmpp.engine.record.counters import count_message, note_departure
from simmpp.engine.record.log import note_answer, note_send
from simmpp.machine.messages import LOAD, OBJECT, RAYS, REQUEST, USER, USER_WORDS, WORD_BYTES
from simmpp.policy.view import View


@kernel
def send_request(s: Run, me: int, other: int, obj: int, now_ps: int) -> int:
    """Ask a PE that has an object for it."""
    row = new_part(s, REQUEST, other, s.request_bytes)
    messages(s)[row].obj = obj
    return post(s, me, row, now_ps)


@kernel
def send_rays(s: Run, me: int, other: int, first: int, last: int, n: int, now_ps: int) -> int:
    """Send n linked rays, first ... last, which must have left the sender's load already."""
    row = new_part(s, RAYS, other, n * s.ray_bytes)
    m = messages(s)[row]
    m.first, m.last, m.n = first, last, n
    return post(s, me, row, now_ps)


@kernel
def send_load(s: Run, me: int, other: int, now_ps: int) -> int:
    """Tell another PE the load, which is in every header: there is nothing else in this message.

    With nic get the other's load.
    """
    row = new_part(s, LOAD, other, s.request_bytes if s.service == BY_NIC else 0)
    if s.service == BY_NIC:
        messages(s)[row].obj = ITS_LOAD
    return send(s, me, row, now_ps, False)


@kernel
def send_user(s: Run, me: int, other: int, view: View, now_ps: int) -> int:
    """Send a message of the policy's own: the words that it has left in its view."""
    row = new_part(s, USER, other, USER_WORDS * WORD_BYTES)
    for i in range(USER_WORDS):
        user_words(s)[USER_WORDS * row + i] = view.words[i]
    return send(s, me, row, now_ps, False)


@kernel
def answer(s: Run, me: int, message: int, now_ps: int, by_thread: bool) -> int:
    """Send what a message asks for, all in one message, to who sent it."""
    answering, part = NONE, message
    while part != NONE:
        m = messages(s)[part]
        if m.kind == REQUEST:
            row = new_part(s, OBJECT, messages(s)[message].source, object_bytes(s)[m.obj])
            messages(s)[row].obj, messages(s)[row].purpose = m.obj, m.purpose
            if answering == NONE:
                answering = row
            else:
                _append(s, answering, row)
        part = m.part
    return send(s, me, answering, now_ps, by_thread) if answering != NONE else now_ps


@kernel
def forget(s: Run, message: int) -> None:
    """Give back the places of a message and its parts."""
    part = message
    while part != NONE:
        m = messages(s)[part]
        following = m.part
        m.kind = NONE
        give_back(messages(s), message_marks(s), part)
        part = following


@kernel
def new_part(s: Run, kind: int, destination: int, payload_bytes: int) -> int:
    """A message of one part, which may become a part of another one."""
    row = take(messages(s), message_marks(s))
    m = messages(s)[row]
    m.kind, m.destination = kind, destination
    m.payload_bytes = m.part_bytes = payload_bytes
    m.obj, m.n = NONE, 0
    m.credit, m.purpose = 0, ORDINARY
    m.part, m.last_part = NONE, row
    m.depart_ps = NONE  # a later part never departs by itself
    return row


@kernel
def _append(s: Run, message: int, part: int) -> None:
    """Make a message of one part the last part of another one."""
    m = messages(s)[message]
    messages(s)[m.last_part].part = part
    m.last_part = part
    m.payload_bytes += messages(s)[part].part_bytes


@kernel
def post(s: Run, me: int, row: int, now_ps: int) -> int:
    """Send what a dispatch has decided on, or put it to what else goes to that PE."""
    if s.packing == SINGLY:
        return send(s, me, row, now_ps, False)
    m = messages(s)[row]
    place = _place(s, me, m)
    if _is_get(s, m):
        outbox(s)[s.n_sent] = row
        s.n_sent += 1
    elif made_up(s)[place] > 0:
        _append(s, made_up(s)[place] - 1, row)
    else:
        made_up(s)[place] = row + 1
        outbox(s)[s.n_sent] = row
        s.n_sent += 1
    return now_ps


@kernel
def _is_get(s: Run, m: Row) -> bool:
    return s.service == BY_NIC and m.kind == REQUEST


@kernel
def _place(s: Run, me: int, m: Row) -> int:
    """Where ``made_up`` has the message that a part goes into; messages depart in this order."""
    distance = (m.destination - me) % s.processors
    alone = m.kind == REQUEST and (s.packing == REQUESTS_TOGETHER or s.service == BY_NIC)
    return distance + s.processors if alone else distance


@kernel
def send_made_up(s: Run, me: int, now_ps: int) -> int:
    """Pack the messages that a dispatch has made up, in ring order from me."""
    n = s.n_sent
    for i in range(n):
        row = outbox(s)[i]
        place = _place(s, me, messages(s)[row])
        made_up(s)[place] = 0
        # Gets of objects of one PE have one place: those that were decided on first come first.
        sort_keys(s)[i], sort_items(s)[i] = (place << 32) + i, row
    sort_by_key(sort_keys(s), sort_items(s), n)
    s.n_sent = 0
    clock_ps = now_ps
    for i in range(n):
        clock_ps = send(s, me, sort_items(s)[i], clock_ps, False)
    return clock_ps


@kernel
def send(s: Run, me: int, row: int, now_ps: int, by_thread: bool) -> int:
    """Pack a message and let it depart; a thread does not know the load within an activity."""
    pe, m = pes(s)[me], messages(s)[row]
    m.source, m.load, m.number = me, pe.settled_load if by_thread else pe.load, pe.messages_sent
    m.depart_ps = now_ps + sending_ps(s, me, m.destination, m.kind) + parts_ps(s, row, PACK)
    depart(s, m)
    pe.messages_sent += 1
    sent_by_kind(s)[m.kind] += 1
    s.bytes_sent += m.payload_bytes + s.header_bytes
    if s.bounded and s.sends:
        m.credit = take_owed(s, me, m.destination)
    if s.packing != SINGLY:
        _count_parts(s, row)
    if s.refresh_ps != NONE:
        note_departure_to(s, me, m)
    if s.logs or s.record_counters:
        _note(s, me, row, now_ps, by_thread)
    outbox(s)[s.n_sent] = row
    s.n_sent += 1
    return m.depart_ps


@kernel
def _note(s: Run, me: int, row: int, now_ps: int, by_thread: bool) -> None:
    if s.logs and by_thread:
        note_answer(s, row, now_ps)
    elif s.logs:
        note_send(s, me, row, now_ps)
    if s.record_counters and by_thread:
        count_message(s, messages(s)[row], 1)
    elif s.record_counters:
        note_departure(s, messages(s)[row])


@kernel
def _count_parts(s: Run, message: int) -> None:
    part = message
    while part != NONE:
        parts_by_kind(s)[messages(s)[part].kind] += 1
        part = messages(s)[part].part
