"""What a run's pictures are made of, counted as it goes, if that is asked for.

Time is cut into bins, 2^k ps wide. How long the run takes is not known before, so they begin
narrow, and pairs of them are joined whenever the run outgrows them: all sums stay exact. Work is
counted when it is over, for the run may end before.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel, njit
from simmpp.common.documented import documented
from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.arrays.records import BINS, NONE, SIZES, Row, Run
from simmpp.engine.arrays.views import (
    communication_bins,
    compute_bins,
    held_bins,
    message_marks,
    messages,
    moments,
    pes,
    rooms,
    sizes,
    slices,
    traffic,
)
from simmpp.machine.messages import RAYS

Ints = NDArray[np.int64]


@documented
class Counters(NamedTuple):
    """Counts of one run; integers, times in ps."""

    bin_ps: int
    """Width of a bin, a power of two."""
    compute_ps: Ints
    """(nb, BINS): time in tests and rays."""
    communication_ps: Ints
    """(nb, BINS): time in startups, packing, unpacking and probes."""
    finished: Ints
    """(BINS,): rays finished by computations that ended then."""
    batches: Ints
    """(3, BINS): messages of rays that departed then, rays in them, rays in the largest."""
    messages: Ints
    """(nb, nb): from row to column."""
    bytes: Ints
    """(nb, nb): with headers."""
    sizes: Ints
    """(kinds, SIZES): messages of each kind whose bytes, with the header, have k binary digits."""
    load_ps: Ints
    """(nb,): rays held times how long."""
    held: NDArray[np.void]
    """(nb, BINS) HELD: what each PE held at the end of each bin; (0, BINS) without a capacity."""


def first_width(least_ps: int) -> int:
    """k of bins 2^k ps wide at the start of a run of at least ``least_ps``."""
    return max(0, (least_ps // BINS).bit_length() - 1)


@kernel
def note_work(s: Run, me: int, begin_ps: int, tests_ps: int, end_ps: int) -> None:
    """A PE communicates from ``begin_ps`` to ``tests_ps``, and then computes until ``end_ps``."""
    count_work(s, me, begin_ps)
    work = slices(s)[me]
    work.begin_ps, work.tests_ps, work.end_ps = begin_ps, tests_ps, end_ps


@kernel
def count_work(s: Run, me: int, now_ps: int) -> None:
    """Count a PE's latest work, as far as it was before ``now_ps``."""
    work = slices(s)[me]
    end_ps = min(work.end_ps, now_ps)
    tests_ps = min(work.tests_ps, now_ps)
    _widen(s, end_ps)
    _spread(communication_bins(s), me * BINS, s.bin_width, work.begin_ps, tests_ps)
    _spread(compute_bins(s), me * BINS, s.bin_width, tests_ps, end_ps)


@kernel
def _spread(bins: Ints, first: int, width: int, begin_ps: int, end_ps: int) -> None:
    """Add the time from begin to end to the bins that it lies in; ``first`` is that of time 0."""
    while begin_ps < end_ps:
        at = begin_ps >> width
        stop_ps = min(end_ps, (at + 1) << width)
        bins[first + at] += stop_ps - begin_ps
        begin_ps = stop_ps


@kernel
def note_load(s: Run, me: int, now_ps: int) -> None:
    """A PE's load is another one from now on; at the makespan all are 0."""
    held = slices(s)[me]
    held.load_ps += held.load * (now_ps - held.since_ps)
    held.load, held.since_ps = pes(s)[me].load, now_ps


@kernel
def note_held(s: Run, me: int, n_rays: int, now_ps: int) -> None:
    """What a PE holds is something else from now on; of a bin the last counts."""
    _widen(s, now_ps)
    here, room = held_bins(s)[me * BINS + (max(now_ps - 1, 0) >> s.bin_width)], rooms(s)[me]
    here.seen, here.fetched, here.rays, here.unread = (
        1,
        room.fetched,
        n_rays * s.ray_bytes,
        room.unread,
    )


@kernel
def note_finished(s: Run, n_rays: int, now_ps: int) -> None:
    """A computation that finished rays ends."""
    _moment(s, now_ps).finished += n_rays


@kernel
def note_departure(s: Run, m: Row) -> None:
    """A message has been packed; rays in it, or in others that were made up with it, have left."""
    count_message(s, m, 1)
    note_load(s, m.source, m.depart_ps)
    if m.kind == RAYS:
        moment = _moment(s, m.depart_ps)
        moment.batches += 1
        moment.rays += m.n
        moment.largest = max(moment.largest, m.n)


@kernel
def count_message(s: Run, m: Row, n: int) -> None:
    """Count a message that departs; with -1, one that never will."""
    n_bytes = m.payload_bytes + s.header_bytes
    pair = traffic(s)[m.source * s.processors + m.destination]
    pair.messages += n
    pair.bytes += n * n_bytes
    digits = math.frexp(float(n_bytes))[1]
    sizes(s)[m.kind * SIZES + min(digits, SIZES - 1)] += n


@kernel
def _moment(s: Run, time_ps: int) -> Row:
    """The bin that ends at, or after, a time."""
    _widen(s, time_ps)
    return moments(s)[max(time_ps - 1, 0) >> s.bin_width]


@kernel
def _widen(s: Run, time_ps: int) -> None:
    """See to it that there are bins up to a time."""
    while time_ps > BINS << s.bin_width:
        s.bin_width += 1
        for first in range(0, s.processors * BINS, BINS):
            _join_pairs(compute_bins(s), first)
            _join_pairs(communication_bins(s), first)
            if s.measures:
                _join_held(held_bins(s), first)
        for i in range(BINS):
            _join_moments(moments(s), i)


@kernel
def _join_pairs(bins: Ints, first: int) -> None:
    half, end = first + BINS // 2, first + BINS
    for i in range(BINS // 2):
        bins[first + i] = bins[first + 2 * i] + bins[first + 2 * i + 1]
    bins[half:end] = 0


@kernel
def _join_held(of_all: NDArray[np.void], first: int) -> None:
    for i in range(BINS):
        to = of_all[first + i]
        if 2 * i < BINS:
            a, b = of_all[first + 2 * i], of_all[first + 2 * i + 1]
            last = b if b.seen else a
            to.seen, to.fetched, to.rays, to.unread = (
                last.seen,
                last.fetched,
                last.rays,
                last.unread,
            )
        else:
            to.seen = 0


@kernel
def _join_moments(of_all: NDArray[np.void], i: int) -> None:
    to = of_all[i]
    if 2 * i < BINS:
        a, b = of_all[2 * i], of_all[2 * i + 1]
        to.finished, to.batches = a.finished + b.finished, a.batches + b.batches
        to.rays, to.largest = a.rays + b.rays, max(a.largest, b.largest)
    else:
        to.finished = to.batches = to.rays = to.largest = 0


@njit
def end_counting(runs: NDArray[np.void]) -> None:
    """The run is over: what goes on ends here, and what has not departed never will."""
    s: Run = runs[0]
    for me in range(s.processors):
        count_work(s, me, s.last_ray_ps)
    for row in range(message_marks(s)[USED]):
        m = messages(s)[row]
        if m.kind != NONE and m.depart_ps > s.last_ray_ps:
            count_message(s, m, -1)
