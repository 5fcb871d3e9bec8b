"""The records that arrays of a run are made of, field by field, and the words of their numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from simmpp.machine.messages import MESSAGE_KINDS

Run = Any
"""A RUN record; numba's type, which Python has no name for."""
Row = Any
"""A record of one of the arrays."""

NONE = -1
ITS_LOAD = -2
"""In place of an object: the get of a PE's load."""

PE = np.dtype(
    [
        ("first", "i4"),  # list of started ready rays, linked through RAY.next; NONE: empty
        ("last", "i4"),
        ("base", "i4"),  # the first PE of its island
        ("place", "i4"),  # its number in the island: base + place is the PE
        ("n_ready", "i8"),  # those and its pixels that are not started
        ("load", "i8"),  # rays held: ready + waiting
        ("settled_load", "i8"),  # load at the end of the last ended activity
        ("sampled_load", "i8"),  # that load when all were last sampled
        ("waits", "i8"),  # rays that ever began to wait: orders waiting rays by age
        ("messages_sent", "i8"),
        ("busy_until_ps", "i8"),
        ("compute_ps", "i8"),
        ("communication_ps", "i8"),
        ("launch_ps", "i8"),  # of compute_ps: startups, and what empty lanes add
        ("pace_times", "i8"),  # tests and rays take times / per of what they cost
        ("pace_per", "i8"),
        ("goes", "i8"),  # at computing so far, with noise
        ("held_bytes", "i8"),  # resident and fetched objects
        ("peak_rays", "i8"),
        ("peak_bytes", "i8"),
        ("peak_object_bytes", "i8"),  # of held_bytes
        ("transient_bytes", "i8"),  # of fetched objects that are kept
        ("n_transient", "i4"),
        ("received_load", "i4"),  # 1 if the last work phase was the receipt of a LOAD message
        ("pixel", "i4"),  # where in ``pixels`` those that are not started begin,
        ("pixel_end", "i4"),  # and end
        ("later", "i4"),  # likewise those of rounds that have not begun
        ("later_end", "i4"),
        ("round", "i4"),  # the first that it has not begun
        ("owes_ps", "i8"),  # for reductions that rounds begin with
        ("cut", "i4"),  # 1: the first ready ray was cut by the quantum
        ("draws", "i8"),  # random numbers that its policy was given
        ("service_ps", "i8"),  # of its thread, which is busy until then:
        ("served_until_ps", "i8"),
        ("in_hand", "i4"),  # the message that its thread unpacks; NONE: none
        ("finished", "i8"),  # rays that ended here
        ("fetched", "i8"),  # objects that have come on request
        ("released", "i8"),  # rays that these made ready
        ("user_sent", "i8"),  # messages of its policy's own, since it last got on
        ("wakes", "i8"),  # times that it was woken since then because its policy wanted to be
        ("wake_ps", "i8"),  # when it wants to be, 0: not at all
        ("woken_ps", "i8"),  # when it was, last
        ("spell", "i4"),  # idle spells, ended by rays or pixels that come; the first is 1
        ("asked", "i4"),  # PEs that it has asked for pixels in this one
        ("awaits", "i4"),  # 1: an answer to that
    ],
    align=True,
)
PACE = (
    "uneven",  # computing takes anything else than the sum of what tests and rays cost
    "noise_key",
    "straggler",  # the PE that is late, NONE: nobody
    "straggler_times",
    "straggler_per",
    "straggler_from_ps",
    "straggler_to_ps",
)
"""Parameters of ``pe.pace``."""
RAY = np.dtype(
    [
        ("tested", "i4"),  # objects of its itinerary that it has been tested against
        ("next", "i4"),  # next ray of the list that this ray is in
        ("granted", "i4"),  # 1: the next tests of one object use it, fetched and pinned for them
        ("hops", "i4"),  # with record_hops: links crossed for it
    ],
    align=True,
)
MISS = np.dtype(
    [
        ("key", "i8"),  # PE * N + object
        ("rank", "i8"),  # in transient memory: the least leaves first
        ("since", "i8"),  # PE.waits when its oldest unasked ray began to wait
        ("chain", "i4"),
        ("first", "i4"),  # waiting rays, oldest first; NONE: none
        ("last", "i4"),
        ("n", "i4"),
        ("unasked", "i4"),  # waiting rays that no request covers
        ("requests", "i4"),  # in flight
        ("pinned", "i4"),  # released rays that have not made their test yet
        ("transient", "i4"),  # 1: in transient memory
        ("peer", "i4"),  # row of the owner in ``peers``, if the policy sends or asks by loads
    ],
    align=True,
)
PEER = np.dtype(
    [
        ("key", "i8"),  # PE * nb + the other PE
        ("load", "i8"),  # last heard; NONE if never
        ("heard_ps", "i8"),
        ("sent_ps", "i8"),  # departure of the last message to it, 0 if none
        ("chain", "i4"),
        ("sendable", "i4"),  # rays waiting for its objects that may be sent
        ("in_flight", "i4"),  # rays sent to it since it was heard
        ("exchanged", "i4"),  # 1: rays or objects went from one to the other
    ],
    align=True,
)
ROUND = np.dtype(
    [
        ("left", "i8"),  # rays that are not finished
        ("end_ps", "i8"),  # the latest end of a ray
        ("begin_ps", "i8"),  # when all know that its roots may start; NONE: not known yet
    ]
)
ROOM = np.dtype(
    [
        ("reserved", "i8"),  # rays that those which are started may become
        ("queue_rays", "i8"),  # for how many rays there is room
        ("resident", "i8"),  # bytes of resident objects
        ("fetched", "i8"),  # bytes of objects asked for, pinned or kept
        ("unread", "i8"),  # bytes of rays in the inbox and in shares, with their headers
        ("peak", "i8"),  # most of resident, fetched, rays, unread together; and what it was made of
        ("first", "i4"),  # received messages of which rays are left, linked through MESSAGE.next
        ("last", "i4"),
        ("stuck", "i4"),  # the ray whose object is on its way to the escape room, or there; or NONE
        ("refused", "i4"),  # bits SENDS, RECEIVES, ASKS: what this dispatch has refused,
        ("stalled", "i4"),  # what the last one has,
        ("since_ps", "i8", (3,)),  # since when,
        ("stalled_ps", "i8", (3,)),  # and how long it was, before
        ("smallest", "i8"),  # no ray in a share needs room for fewer
        ("control", "i8"),  # bytes of unread requests, and of headers without rays
        ("peak_control", "i8"),
        ("peak_fetched", "i8"),
        ("peak_queue", "i8"),
        ("peak_receive", "i8"),
        ("share", "i8"),  # bytes for the rays of each other PE
        ("share_rays", "i8"),  # rays that these are at least, in one message
        ("fetch_bytes", "i8"),  # for fetched objects
        ("escapes", "i8"),
        ("credit_messages", "i8"),
    ],
    align=True,
)
"""A PE's memory, where it ends."""
CREDIT = np.dtype(
    [
        ("used", "i8"),  # bytes of the share that the other keeps for this PE
        ("owed", "i8"),  # bytes of the share for the other that are free; it is not told yet
    ]
)
"""Flow of rays between a PE and another, beside its row of PEER."""
MESSAGE = np.dtype(
    [
        ("depart_ps", "i8"),
        ("number", "i8"),  # the sender's send number
        ("load", "i8"),  # the sender's, at packing, without the rays in the message
        ("payload_bytes", "i8"),  # of all parts of the message
        ("part_bytes", "i8"),  # of this part alone
        ("arrival_ps", "i8"),
        ("busy_ps", "i8"),  # with contention: how long its bytes take from port to port,
        ("head_ps", "i8"),  # when its head is at the next link or port,
        ("credit", "i8"),  # bytes of the receiver's share that are free again
        ("at", "i4"),  # and the node where that is, as the topology numbers it
        ("destination", "i4"),
        ("source", "i4"),
        ("chain", "i4"),
        ("next", "i4"),  # in the inbox
        ("part", "i4"),  # the message's next part, which is a row of its own; NONE: the last
        ("last_part", "i4"),  # of a message, in the row of its first part
        ("obj", "i4"),  # NONE: none; ITS_LOAD: a load is got
        ("first", "i4"),  # rays
        ("last", "i4"),
        ("n", "i4"),
        ("kind", "i4"),  # of this part, and so of the message; NONE: a free place
        # ORDINARY, FOR_ESCAPE (a request, an object), FOR_CREDIT (a load), FOR_PIXELS (who steals
        # asks; the answer is ordinary, and has its pixels from ``first`` on, where ``pixels`` has
        # them, not linked)
        ("purpose", "i4"),
    ],
    align=True,
)
COPY = np.dtype([("fixed_ps", "i8"), ("bytes_per_s", "i8")])
"""Cost of packing each kind of message, then of unpacking each."""

EVENT = np.dtype(
    [
        ("time_ps", "i8"),  # when a message arrives, or the PE begins
        ("end_ps", "i8"),  # when the PE is done, a message sent departs; of an arrival: time_ps
        ("number", "i8"),  # the sender's send number; NONE if there is no message or it never left
        ("payload_bytes", "i8"),
        ("tests", "i8"),
        ("pe", "i4"),  # who receives, computes or sends; destination of an arrival
        ("other", "i4"),  # who the message comes from or, SEND, goes to; NONE without one
        ("rays", "i4"),  # in the message; finished by a COMPUTE
        ("objects", "i4"),  # in the message
        ("requests", "i4"),  # in the message
        ("load", "i4"),  # of the PE, when it is done
        ("ready", "i4"),  # rays of the load that are ready then; the others wait
        ("event", "i2"),  # ARRIVAL, RECEIVE, COMPUTE, SEND, SERVE or ANSWER
        ("kind", "i2"),  # of the message; NONE without one
    ]
)
"""One row of the event log."""

EVENT_KEY = np.dtype(
    [
        ("time_ps", "i8"),
        ("rank", "i8"),  # destination * 2^31 + source, INSTANT + PE or HEAD + source
        ("number", "i8"),  # the sender's send number, or the PE's instants so far
        ("message", "i8"),  # that arrives or whose head moves; NONE at an instant
    ]
)
"""What is going to happen in the compiled event loop, and its place among the rest."""
PROCESS = np.dtype(
    [
        ("first", "i4"),  # inbox of the PE, linked through MESSAGE.next; NONE: empty
        ("last", "i4"),
        ("instants", "i8"),
        ("phase", "i4"),  # of the next instant
        ("asleep", "i4"),
    ]
)
"""A PE, or its thread, as the compiled event loop sees it."""

BINS = 1024
"""Bins of time; a run fills more than half of them."""
SIZES = 48
"""Sizes of messages are counted by powers of two."""

MOMENT = np.dtype(
    [
        ("finished", "i8"),  # rays finished by computations that ended in the bin
        ("batches", "i8"),  # messages of rays that departed in it,
        ("rays", "i8"),  # rays in them,
        ("largest", "i8"),  # rays in the largest
    ]
)
"""What all PEs together did in a bin."""
HELD = np.dtype(
    [
        ("seen", "i8"),  # 1: the PE had an instant in the bin
        ("fetched", "i8"),  # bytes at the end of the last one, as in ROOM
        ("rays", "i8"),
        ("unread", "i8"),
    ]
)
"""What a PE holds besides its resident objects, where memory ends."""
TRAFFIC = np.dtype([("messages", "i8"), ("bytes", "i8")])
"""From one PE to another, with headers."""
SLICE = np.dtype(
    [
        ("begin_ps", "i8"),  # of the PE's latest work: communication, then
        ("tests_ps", "i8"),  # tests and rays from here on
        ("end_ps", "i8"),
        ("load", "i8"),
        ("since_ps", "i8"),  # when the load became that
        ("load_ps", "i8"),  # rays held times how long, until then
    ]
)
"""What is counted of a PE when it works again, or the run is over: it may end before the work."""

ORDINARY, FOR_ESCAPE, FOR_CREDIT, FOR_PIXELS = range(4)
PIGGYBACK, EXACT, NO_INFO, SAMPLED, TWO = range(5)
LOAD_INFO = {
    "piggyback": PIGGYBACK,
    "exact": EXACT,
    "none": NO_INFO,
    "sampled": SAMPLED,
    "two": TWO,
}
SINGLY, REQUESTS_TOGETHER, ALL_TOGETHER = range(3)
PACKING = {"none": SINGLY, "requests": REQUESTS_TOGETHER, "all": ALL_TOGETHER}
BEGIN, DISPATCH, REST, WOKEN = range(4)
"""Phases of a PE's instants: an activity begins, or has ended and its policy decides; what ``idle``
said, or a question for pixels, has been sent, and the PE sleeps if no message has come; the time
that ``idle`` gave is there, unless a message was before it."""
SLEEP = -1
"""In place of the time of a PE's next instant: none, until a message arrives."""
ARRIVAL, RECEIVE, COMPUTE, SEND, SERVE, ANSWER = range(6)
BY_PE, BY_THREAD, BY_NIC = range(3)
SERVICE = {"pe": BY_PE, "thread": BY_THREAD, "nic": BY_NIC}
PACK, UNPACK = 0, len(MESSAGE_KINDS)
