"""Which objects rays use, seen beforehand at a few pixels: on all PEs together, and on each."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.workload import Workload

COARSE_STEP = 4
"""The itineraries of every 4th row's every 4th pixel are counted (ESTIMATE: a 1/16 pre-pass)."""

Ids = NDArray[np.int32]


def uses(workload: Workload) -> NDArray[np.int64]:
    """How often the rays of these pixels test each object: (N,) int64."""
    _, tested = _tests(workload)
    return np.bincount(tested, minlength=workload.n_objects)


class UsesByPE:
    """How often they do on the PE that each pixel starts on, of those objects that they test."""

    def __init__(self, workload: Workload, pixel_pes: Ids) -> None:
        rays, tested = _tests(workload)
        n_objects = max(workload.n_objects, 1)
        pairs = pixel_pes[workload.pixels[rays]].astype(np.int64) * n_objects + tested
        found, self.counts = np.unique(pairs, return_counts=True)
        self.pes, self.objects = np.divmod(found, n_objects)
        """(k,) int64 each, PEs rising: PE pes[i] uses object objects[i] counts[i] times."""
        self._n_objects = workload.n_objects

    def of(self, pe: int) -> NDArray[np.int64]:
        """Those of one PE: (N,) int64."""
        first, end = np.searchsorted(self.pes, (pe, pe + 1))
        found = np.zeros(self._n_objects, np.int64)
        found[self.objects[first:end]] = self.counts[first:end]
        return found


def _tests(workload: Workload) -> tuple[NDArray[np.int64], Ids]:
    """The ray and the object of each test at these pixels."""
    rows, columns = np.divmod(workload.pixels % workload.n_pixels, workload.picture[1])
    sampled = (rows % COARSE_STEP == 0) & (columns % COARSE_STEP == 0)
    lengths = np.diff(workload.itinerary_offsets)
    tested = np.repeat(sampled, lengths)
    rays = np.repeat(np.arange(workload.n_rays), lengths)
    return rays[tested], workload.itinerary_objects[tested]
