"""What the PE that ever held most holds, over time, where memory has a capacity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.engine.capacity import capacity_bytes, needs_of
from simmpp.engine.record.counters import Ints
from simmpp.run.point import Point, PolicyRun


@dataclass(frozen=True, eq=False)
class Fullest:
    """One PE; bytes at the end of each of B bins of time."""

    pe: int
    capacity_bytes: int
    resident: int
    kept_free: int
    """For one request of each other PE, and for the escape."""
    fetched: Ints
    """(B,): objects asked for, in use, or kept."""
    rays: Ints
    """(B,): what those that are started and taken in may become; without credits, these."""
    unread: Ints
    """(B,): rays that lie unread or in shares, with the headers of their messages."""


def fullest_of(point: Point, run: PolicyRun, n_bins: int) -> Fullest | None:
    """Of the PE that held most at the end of any bin; None without a capacity."""
    counters, bounds = run.result.counters, point.placement.capacity
    if bounds is None or counters is None:
        return None
    needs = needs_of(point.workload, point.machine, point.placement, run.parameters)
    held = _lasting(counters.held[:, :n_bins])
    fetched, rays, unread = held["fetched"], held["rays"], held["unread"]
    permanent, resident = needs.permanent, needs.resident
    pe = int((permanent + (fetched + rays + unread).max(axis=1)).argmax())
    return Fullest(
        pe,
        capacity_bytes(bounds, needs),
        int(resident[pe]),
        int(permanent[pe] - resident[pe]),
        fetched[pe],
        rays[pe],
        unread[pe],
    )


def _lasting(held: NDArray[np.void]) -> NDArray[np.void]:
    """Until something else is said, a PE holds what it held before."""
    at = np.where(held["seen"] == 1, np.arange(held.shape[1]), 0)
    return np.take_along_axis(held, np.maximum.accumulate(at, axis=1), axis=1)
