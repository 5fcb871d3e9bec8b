"""What a run's pictures are made of, counted while its event log goes by.

Time is cut into bins, 2^k ps wide. How long the run takes is not known before, so they begin
narrow, and pairs of them are joined whenever the run outgrows them: all sums stay exact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.compiled import njit
from simmpp.engine.layout import ARRIVAL, COMPUTE, NONE, SEND
from simmpp.machine.machine import Machine
from simmpp.machine.messages import RAYS

BINS = 1024
"""Bins of time; a run fills more than half of them."""
SIZES = 48
"""Sizes of messages are counted by powers of two."""

Ints = NDArray[np.int64]


class Counters(NamedTuple):
    """Counts of one run so far; integers."""

    width: Ints
    """(1,): k, for bins 2^k ps wide."""
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
    """(4, SIZES): messages of each kind whose bytes, with the header, have k binary digits."""
    load_ps: Ints
    """(nb,): rays held times how long."""
    last: Ints
    """(2, nb): each PE's load, and since when."""


def new_counters(initial_load: Ints, least_ps: int) -> Counters:
    """Counters at the start of a run of at least ``least_ps``.

    ``initial_load`` (nb,) int64 are the rays that each PE holds then.
    """
    nb = len(initial_load)
    shapes = {
        "width": 1,
        "compute_ps": (nb, BINS),
        "communication_ps": (nb, BINS),
        "finished": BINS,
        "batches": (3, BINS),
        "messages": (nb, nb),
        "bytes": (nb, nb),
        "sizes": (4, SIZES),
        "load_ps": nb,
    }
    zeros = {name: np.zeros(shape, np.int64) for name, shape in shapes.items()}
    zeros["width"][:] = max(0, (least_ps // BINS).bit_length() - 1)
    return Counters(**zeros, last=np.array([initial_load, np.zeros(nb)], np.int64))


class MotionRecorder:
    """Counts the rows of an event log."""

    def __init__(self, machine: Machine, initial_load: Ints, least_ps: int = 0) -> None:
        self.counters = new_counters(initial_load, least_ps)
        self._probe_ps = machine.probe_ps
        self._header_bytes = machine.header_bytes

    def __call__(self, rows: NDArray[np.void]) -> None:
        """Count these too."""
        _count(self.counters, rows, self._probe_ps, self._header_bytes)

    def end(self, makespan_ps: int) -> Counters:
        """The run is over."""
        load, since_ps = self.counters.last
        self.counters.load_ps[:] += load * (makespan_ps - since_ps)
        since_ps[:] = makespan_ps
        return self.counters


@njit
def _count(c: Counters, rows: NDArray[np.void], probe_ps: int, header_bytes: int) -> None:
    for i in range(rows.size):
        row = rows[i]
        if row.event == ARRIVAL:
            continue
        while row.end_ps > BINS << c.width[0]:
            _join_bins(c)
        c.load_ps[row.pe] += c.last[0, row.pe] * (row.end_ps - c.last[1, row.pe])
        c.last[0, row.pe], c.last[1, row.pe] = row.load, row.end_ps
        begin_ps = row.time_ps
        if row.event == COMPUTE:
            _spread(c.communication_ps[row.pe], c.width[0], begin_ps, begin_ps + probe_ps)
            _spread(c.compute_ps[row.pe], c.width[0], begin_ps + probe_ps, row.end_ps)
            c.finished[_bin(c, row.end_ps)] += row.rays
        else:
            _spread(c.communication_ps[row.pe], c.width[0], begin_ps, row.end_ps)
            if row.event == SEND and row.number != NONE:
                _count_message(c, row.pe, row.other, row.kind, row.payload_bytes + header_bytes)
                if row.kind == RAYS:
                    _count_batch(c, _bin(c, row.end_ps), row.rays)


@njit
def _count_message(c: Counters, source: int, destination: int, kind: int, n_bytes: int) -> None:
    c.messages[source, destination] += 1
    c.bytes[source, destination] += n_bytes
    digits = 0
    while n_bytes >> digits and digits < SIZES - 1:
        digits += 1
    c.sizes[kind, digits] += 1


@njit
def _count_batch(c: Counters, time_bin: int, n_rays: int) -> None:
    c.batches[0, time_bin] += 1
    c.batches[1, time_bin] += n_rays
    c.batches[2, time_bin] = max(c.batches[2, time_bin], n_rays)


@njit
def _bin(c: Counters, time_ps: int) -> int:
    """The bin that ends at, or after, a time."""
    return max(time_ps - 1, 0) >> c.width[0]


@njit
def _spread(bins: Ints, width: int, begin_ps: int, end_ps: int) -> None:
    """Add the time from begin to end to the bins that it lies in."""
    while begin_ps < end_ps:
        at = begin_ps >> width
        stop_ps = min(end_ps, (at + 1) << width)
        bins[at] += stop_ps - begin_ps
        begin_ps = stop_ps


@njit
def _join_bins(c: Counters) -> None:
    """Make every bin twice as wide."""
    c.width[0] += 1
    for pe in range(c.load_ps.size):
        _join_pairs(c.compute_ps[pe])
        _join_pairs(c.communication_ps[pe])
    _join_pairs(c.finished)
    _join_pairs(c.batches[0])
    _join_pairs(c.batches[1])
    for i in range(BINS):
        pair = 2 * i
        c.batches[2, i] = max(c.batches[2, pair], c.batches[2, pair + 1]) if pair < BINS else 0


@njit
def _join_pairs(bins: Ints) -> None:
    for i in range(BINS):
        bins[i] = bins[2 * i] + bins[2 * i + 1] if 2 * i < BINS else 0
