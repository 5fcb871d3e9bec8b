"""What a hook sees: one record, which is filled before each question."""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence
from typing import TYPE_CHECKING

WORDS = 8
"""Numbers in ``parameter`` and in ``memory``."""
NUMBERS = ("min_load", "batch", "ask_at_least")
"""Numbers of ``PolicyParameters``, which every policy has."""


class View:
    """What a PE may know when its policy decides; whole numbers (int64), in this order in memory.

    *The other* is, in ``send``, the PE that rays may go to; in ``ask`` and ``keep``, the owner of
    the object; in ``heard`` who sent the message; in ``idle`` there is none. What is said of
    ``ask`` holds for ``keep``; in ``heard`` and ``idle`` there is no object, as in ``send``. A hook
    gets, of the fields below, those
    that it reads; what it does not read costs nothing. A
    further field is a line at the end, its group in ``GROUPS`` if it has to be looked up, and its
    value in ``engine.pe.showing``.
    """

    now_ps: int
    """The PE's clock, in picoseconds since the start."""
    me: int
    """The number of this PE, from 0; with islands in its island, as those of all that it sees."""
    nb: int
    """How many PEs there are, with islands in its own."""
    load: int
    """Rays that this PE holds, ready or waiting."""
    ready: int
    """Those of them that are ready."""
    held_bytes: int
    """Bytes of the objects in its memory, resident and fetched."""
    nothing_else: int
    """1 if no ray was ready and the inbox empty when this dispatch began, else 0; ``keep`` and
    ``heard``: 0; ``idle``: 1."""
    initial_load: int
    """All primary rays / all PEs, rounded down: what is known of a PE before it is heard."""
    other: int
    """The other PE; ``idle``: -1, or for the hook to write: the PE that ``words`` go to."""
    known_load: int
    """Load last heard of the other; -1: not known (load_info none)."""
    age_ps: int
    """Time since that was heard (since the start if never, 0 if exact)."""
    in_flight: int
    """Rays sent to the other since its load was heard; 0 where loads are not in headers."""
    hops: int
    """Links between this PE and the other."""
    send_ps: int
    """What sending costs this PE: ``send`` all waiting rays in one message, ``ask`` a request,
    ``heard`` and ``idle`` a message of the policy's own."""
    receive_ps: int
    """What receiving costs: ``send`` the other, for these rays; ``ask`` this PE, for the object;
    ``heard`` and ``idle`` a message of the policy's own."""
    flight_ps: int
    """Time in between without contention: ``send`` of the message; ``ask`` of the request, of its
    answer, and what answering takes; ``heard`` of an answer; ``idle`` 0."""
    object: int
    """``ask``: the object's number; ``send``: -1, and what follows of objects is 0."""
    object_bytes: int
    """Its size on the wire."""
    test_ps: int
    """What one test against it costs."""
    owner: int
    """The PE that owns it."""
    holders: int
    """PEs that have it in memory for good, the owner among them."""
    waiting: int
    """``send``: rays that wait and may go to the other. ``ask``: rays that wait for the object.
    ``heard``, ``idle``: all that wait."""
    unasked: int
    """``ask``: those of them that no request covers; else 0."""
    requests: int
    """``ask``: requests for it that are in flight."""
    min_load: int
    """What the configuration says, a share of n0 / nb as the floor of that many rays."""
    batch: int
    """Likewise."""
    ask_at_least: int
    """Likewise."""
    parameter: Sequence[int]
    """(8,) the policy's own numbers, in the order in which it declares them."""
    memory: MutableSequence[int]
    """(8,) for the policy to write: the PE's own, 0 at the start, kept from call to call."""
    random: int
    """A draw of 0 <= random < 2^63 for this question, made if a hook reads it: Philox4x64-10 with a
    key from the seed and the PE, and the PE's draws so far as counter."""
    finished: int
    """Rays that this PE has finished."""
    busy_ps: int
    """Time that it has worked; of an activity that is not over, the work before its dispatch."""
    compute_ps: int
    """Of this, time in tests and rays, and not in messages."""
    fetched: int
    """Objects that have come because it had asked for them."""
    released: int
    """Rays that these made ready."""
    objects: int
    """``send``: different objects that the waiting rays need next; ``ask``: 1."""
    fetch_ps: int
    """What fetching these from their owners would cost this PE, each request and object a message
    of its own."""
    fetch_flight_ps: int
    """Time in between, one after the other: flights without contention, what answering takes."""
    words: MutableSequence[int]
    """(4,) of a message of the policy's own: ``heard`` those that came, ``idle`` 0; for the hook to
    write those that it sends."""
    speed: int
    """Tests that this PE makes in the time of 1000 on one of speed 1 (`machine.speed`)."""
    other_speed: int
    """Likewise the other; ``idle``: 0."""

    if TYPE_CHECKING:

        def __getattr__(self, number: str) -> int:
            """One of the policy's own numbers."""


SELF, LOADS, WAY, OBJECT, RANDOM, DONE, WANTED, SPEEDS = (1 << n for n in range(8))
GROUPS = {
    SELF: ("now_ps", "me", "ready", "held_bytes"),
    LOADS: ("known_load", "age_ps", "in_flight"),
    WAY: ("hops", "send_ps", "receive_ps", "flight_ps"),
    OBJECT: ("object", "object_bytes", "test_ps", "owner", "holders", "requests"),
    RANDOM: ("random",),
    DONE: ("finished", "busy_ps", "compute_ps", "fetched", "released"),
    WANTED: ("objects", "fetch_ps", "fetch_flight_ps"),
    SPEEDS: ("speed", "other_speed"),
}
"""Fields that are looked up together, if a hook reads any of them; the others always are there."""
