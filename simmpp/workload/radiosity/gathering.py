"""Form factors from counts of rays, and the light that they let patches exchange.

Lamps send out rays first, then whatever these have landed on, and so on: sides that no light
reaches, as the insides of solids, send none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from simmpp.common.errors import SceneError
from simmpp.workload.radiosity.room import Room
from simmpp.workload.radiosity.settings import LEAST_RAYS
from simmpp.workload.room import require_memory, require_numbers
from simmpp.workload.trace.ray_batch import RayBatch

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
ENOUGH = 1e-13
"""Change of a bounce, as a share of the brightest side, below which there are no more."""
MOST_BOUNCES = 20_000


class Gathering:
    """Wave after wave of rays, and what they have found."""

    def __init__(self, room: Room) -> None:
        """Nothing has been sent."""
        self._room = room
        areas = room.patches.areas
        counts = np.floor(room.settings.rays * (areas / areas.mean()) + 0.5).astype(np.int64)
        self._counts = np.maximum(counts, LEAST_RAYS).repeat(2)
        self._next = np.flatnonzero((room.patches.emitted > 0).any(axis=1).repeat(2))
        self._reached = np.zeros(room.n_sides, np.bool_)
        self._pairs: list[tuple[Ints, Ints]] = []
        self._n_sent = 0

    def rays(self) -> RayBatch | None:
        """The next wave; None if there is none."""
        if not len(self._next):
            return None
        counts = self._counts[self._next]
        self._n_sent += int(counts.sum())
        require_numbers(self._n_sent, self._room.name)
        require_memory(self._n_sent, self._room.name)
        self._reached[self._next] = True
        return self._room.leaving(self._next, counts, np.zeros_like(counts))

    @property
    def homes(self) -> NDArray[np.int32]:
        """The patch that each ray of the wave leaves, (n,) int32."""
        return np.repeat(self._next // 2, self._counts[self._next]).astype(np.int32)

    def take(self, places: Ints, done: Flags | None = None) -> None:
        """The sides (n,) on which a wave has landed; only ``done`` rays are counted, if given."""
        sent = np.repeat(self._next, self._counts[self._next])
        chosen = slice(None) if done is None else done
        self._pairs.append((sent[chosen], places[chosen]))
        found = np.unique(places[places >= 0])
        self._next = found[~self._reached[found]]

    @property
    def pairs(self) -> tuple[Ints, Ints]:
        """The sides that all counted rays have left, and where they have landed."""
        sent, places = (np.concatenate(column) for column in zip(*self._pairs, strict=True))
        return sent, places

    def require_end(self) -> None:
        """Raise SceneError unless light from every side can get out or be absorbed somewhere."""
        reflectance = self._room.patches.reflectance.repeat(2, 0)
        if not (reflectance >= 1).any():
            return
        factors = form_factors(self._room.n_sides, *self.pairs)
        ends = (reflectance < 1) | (factors.sum(axis=1) < 1 - ENOUGH)[:, None]
        while (ends != (more := ends | (factors @ ends > 0))).any():
            ends = more
        shines = (self._room.patches.emitted > 0).any(axis=0)
        if not ends[self._reached][:, shines].all():
            raise self._room.endless()

    @property
    def brightness(self) -> Floats:
        """(2 N, 3) float64: what each side looks like, in units of what lamps emit."""
        patches = self._room.patches
        emitted, reflectance = patches.emitted.repeat(2, 0), patches.reflectance.repeat(2, 0)
        try:
            return brightness(form_factors(self._room.n_sides, *self.pairs), emitted, reflectance)
        except SceneError as error:
            raise SceneError(error.problem, where=self._room.name) from None


def form_factors(n: int, sent: Ints, places: Ints) -> csr_array:
    """(n, n): which share of the rays that side i has sent out lands on side j."""
    found = places >= 0
    pairs = sent[found], places[found]
    counts = csr_array((np.ones(len(pairs[0])), pairs), shape=(n, n))
    counts.sum_duplicates()
    counts.data /= np.repeat(np.bincount(sent, minlength=n), np.diff(counts.indptr))
    return counts


def brightness(
    factors: csr_array, emitted: Floats, reflectance: Floats, bounces: int | None = None
) -> Floats:
    """B = E + rho F B: light of n sides (n, 3), bounce by bounce (Jacobi's iteration).

    Until the next bounce adds nothing, or for so many ``bounces``. SceneError if it never ends.
    """
    light = emitted
    for _ in range(MOST_BOUNCES if bounces is None else bounces):
        after = emitted + reflectance * (factors @ light)
        change, light = np.abs(after - light).max(initial=0.0), after
        if bounces is None and change <= ENOUGH * light.max(initial=0.0):
            break
    else:
        if bounces is None:
            raise SceneError(f"light goes on after {MOST_BOUNCES} bounces: too little is absorbed")
    return light
