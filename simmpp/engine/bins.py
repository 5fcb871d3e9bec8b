"""How the counters of a run lie in memory: of bins of time, of pairs of PEs, of PEs."""

from __future__ import annotations

import numpy as np

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
