"""Progressive radiosity: the side with the most unshot power shoots, then the next one.

Cohen et al. 1988, "A progressive refinement approach to fast radiosity image generation", with
rays as in Wallace et al. 1989. Power is counted in whole units, so none is ever lost: what lamps
emit has been absorbed, has escaped, or is unshot.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.radiosity.room import Room
from simmpp.workload.room import require_numbers
from simmpp.workload.trace.ray_batch import RayBatch

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
BITS = 50
"""All emitted power is 2^50 to 2^51 units, so that no product of float64 loses one."""
STALLED = 0.999
"""Light that has more than this left after as many rounds as there are sides will never end."""
UNIT_W = 2.0**-32
"""A unit as weights of rays have it: lamps together have about 2^18 W, whatever the scene's."""


class Shooting:
    """What the 2 N sides have and have sent, in units; red, green and blue."""

    def __init__(self, room: Room) -> None:
        """Lamps are full."""
        self._room, patches = room, room.patches
        powers = (patches.emitted * patches.areas[:, None]).repeat(2, 0)
        _, exponent = math.frexp(math.fsum(powers.ravel().tolist()))
        self._scale = math.ldexp(1.0, BITS + 1 - exponent)
        self.emitted: Ints = np.rint(powers * self._scale).astype(np.int64)
        self.unshot = self.emitted.copy()
        self.sent = self.emitted.copy()
        """(2 N, 3) int64: what has left each side, or will: emitted and reflected."""
        self.absorbed, self.escaped = np.zeros((2, 3), np.int64)
        self._shots = np.zeros(room.n_sides, np.int64)
        self._side, self._n_rounds, self._is_over = -1, 0, False
        self._left = int(self.unshot.sum())

    @property
    def residual(self) -> Fraction:
        """Share of the emitted power that is unshot."""
        return Fraction(int(self.unshot.sum()), int(self.emitted.sum()))

    def rays(self) -> RayBatch | None:
        """The next round: of the side with most unshot power in all colours, of several the first.

        None if little enough is unshot.
        """
        settings = self._room.settings
        if self._is_over or self.residual <= settings.residual:
            return None
        require_numbers(settings.rays * (self._n_rounds + 1), self._room.name)
        side = self._side = int(self.unshot.sum(axis=1).argmax())
        return self._room.leaving(np.array([side]), np.array([settings.rays]), self._shots[[side]])

    @property
    def homes(self) -> NDArray[np.int32]:
        """The patch that each ray of the round leaves, (n,) int32."""
        return np.full(self._room.settings.rays, self._side // 2, np.int32)

    @property
    def powers(self) -> Ints:
        """What each ray of the round takes with it, (n, 3): the first have a division's rest."""
        n = self._room.settings.rays
        each, rest = np.divmod(self.unshot[self._side], n)
        powers: Ints = each + (np.arange(n)[:, None] < rest)
        return powers

    def take(self, places: Ints, done: Flags | None = None) -> None:
        """The sides (n,) on which a round has landed; the last one if not all are ``done``."""
        if done is not None and not done.all():
            self._is_over = True
            return
        powers, found = self.powers, places >= 0
        at, arriving = places[found], powers[found]
        reflected = np.floor(arriving * self._room.patches.reflectance[at // 2]).astype(np.int64)
        self.unshot[self._side] = 0
        for received in (self.unshot, self.sent):
            np.add.at(received, at, reflected)
        self.escaped += powers[~found].sum(axis=0)
        self.absorbed += arriving.sum(axis=0) - reflected.sum(axis=0)
        self._shots[self._side] += 1
        self._n_rounds += 1
        if self._n_rounds % self._room.n_sides == 0:
            before, self._left = self._left, int(self.unshot.sum())
            if self._left > STALLED * before:
                raise self._room.endless()

    @property
    def brightness(self) -> Floats:
        """(2 N, 3) float64: what each side looks like, in units of what lamps emit."""
        areas = self._room.patches.areas.repeat(2)
        light: Floats = self.sent / (areas[:, None] * self._scale)
        return light
