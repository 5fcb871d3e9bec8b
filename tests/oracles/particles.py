"""Particles followed once more, slowly: one at a time, with the mathematical library's functions.

The numbers of chance are counted by the cipher written out here. Cells, parts and weights must be
the package's; lengths agree to rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from simmpp.workload.particles.cells import Cells
from simmpp.workload.particles.settings import Particles

ONE, BELOW = 2**32, 2**32


@dataclass
class Flight:
    """One particle: the cells of its segments, and what it leaves in each."""

    parent: Flight | None
    cells: list[int] = field(default_factory=list)
    absorbed: list[int] = field(default_factory=list)
    lengths: list[float] = field(default_factory=list)
    side: int | None = None
    """By which it left."""
    roulette: int = 0
    children: list[Flight] = field(default_factory=list)


def philox(counter: tuple[int, ...], key: tuple[int, int]) -> list[float]:
    (a, b, c, d), (k, m) = counter, key
    for _ in range(10):
        one, other = 0xD2511F53 * a, 0xCD9E8D57 * c
        a, b, c, d = other // BELOW ^ b ^ k, other % BELOW, one // BELOW ^ d ^ m, one % BELOW
        k, m = (k + 0x9E3779B9) % BELOW, (m + 0xBB67AE85) % BELOW
    return [(word + 0.5) / BELOW for word in (a, b, c, d)]


class Follower:
    """Follows roots of a source."""

    def __init__(self, cells: Cells, particles: Particles) -> None:
        self.how, self.source, self.shape = particles, cells.source, np.array(cells.shape)
        self.widths = np.array(cells.size) / self.shape
        self.mirrors = [s in cells.mirrors for s in ("-x", "+x", "-y", "+y", "-z", "+z")]
        x, y, z = cells.shape
        self.materials, self.importances = {}, {}
        for place in np.ndindex(x, y, z):
            centre = (np.array(place) + 0.5) * self.widths
            self.materials[place], self.importances[place] = None, 1
            for box in cells.boxes:
                if (centre >= box.low).all() and (centre <= box.high).all():
                    self.materials[place] = cells.materials[box.material]
                    self.importances[place] = box.importance

    def number(self, place: tuple[int, ...]) -> int:
        return place[0] + self.shape[0] * (place[1] + self.shape[1] * place[2])

    def draw(self, branch: int, event: int, dimension: int = 0) -> list[float]:
        return philox((event, dimension, branch, 0), (self.how.seed, self.root))

    def follow(self, root: int) -> list[Flight]:
        """A root and its parts, each part behind its parent, in the order of their branches."""
        self.root, self.flights, self.waiting = root, [], []
        a, u = self.draw(0, 0), self.draw(0, 0, 1)
        low = np.array(self.source.low)
        high = np.array(self.source.high or self.source.low)
        position = low + np.array(a[:3]) * (high - low)
        place = tuple(np.minimum((position / self.widths).astype(int), self.shape - 1).tolist())
        axis = np.array(self.source.towards) / np.linalg.norm(self.source.towards)
        direction = {
            "beam": lambda: axis,
            "cosine": lambda: turned(axis, math.sqrt(u[0]), u[1]),
            "isotropic": lambda: turned(np.array([0, 0, 1.0]), 2 * u[0] - 1, u[1]),
        }[self.source.emits]()
        self.fly(Flight(None), 0, position, direction, place, ONE, -math.log(u[2]))
        branches = 0
        while self.waiting:
            flight, position, direction, place, weight = self.waiting.pop(0)
            branches += 1
            ahead = -math.log(self.draw(branches, 0)[3])
            self.fly(flight, branches, position, direction, place, weight, ahead)
        return self.flights

    def fly(self, flight, branch, position, direction, place, weight, ahead) -> None:
        self.flights.append(flight)
        event = 0
        while weight > 0:
            material = self.materials[place]
            sigma, albedo, g = (
                (material.sigma_t, material.albedo, material.g) if material else (0, 0, 0)
            )
            distance, axis = self.side_ahead(position, direction, place)
            flight.cells.append(self.number(place))
            flight.absorbed.append(0)
            flight.lengths.append(min(distance, ahead / sigma if sigma else math.inf))
            position = position + flight.lengths[-1] * direction
            if sigma * distance > ahead:
                event += 1
                chance, u, v, w = self.draw(branch, event)
                if self.how.capture == "implicit":
                    kept = math.floor(weight * albedo + 0.5)
                else:
                    kept = weight if chance < albedo else 0
                flight.absorbed[-1] = weight - kept
                weight, ahead = kept, -math.log(w)
                direction = scattered(direction, g, u, v)
                if self.how.capture == "implicit" and 0 < weight < int(0.01 * ONE):
                    event += 1
                    weight = self.thinned(flight, branch, event, weight, 10)
                continue
            ahead -= sigma * distance
            up = direction[axis] > 0
            position[axis] = (place[axis] + up) * self.widths[axis]
            new = place[axis] + (1 if up else -1)
            if not 0 <= new < self.shape[axis]:
                if not self.mirrors[2 * axis + up]:
                    flight.side = 2 * axis + int(up)
                    return
                direction = direction.copy()
                direction[axis] *= -1
                continue
            before, place = place, (*place[:axis], new, *place[axis + 1 :])
            old, now = self.importances[before], self.importances[place]
            if self.how.splitting and now > old:
                n = now // old
                shares = [weight // n + (i < weight % n) for i in range(n)]
                parts = [(Flight(flight), position, direction, place, share) for share in shares]
                flight.children = [part[0] for part in parts]
                self.waiting = parts + self.waiting
                return
            if self.how.splitting and now < old:
                event += 1
                weight = self.thinned(flight, branch, event, weight, old // now)

    def side_ahead(self, position, direction, place) -> tuple[float, int]:
        found = [(math.inf, 0)]
        for k in range(3):
            if direction[k] != 0:
                plane = (place[k] + (direction[k] > 0)) * self.widths[k]
                found.append(((plane - position[k]) / direction[k], k))
        distance, axis = min(found)
        return max(0.0, distance), axis

    def thinned(self, flight: Flight, branch: int, event: int, weight: int, n: int) -> int:
        kept = weight * n if self.draw(branch, event)[0] < 1 / n else 0
        flight.roulette += weight - kept
        return kept


def scattered(axis, g: float, u: float, turns: float):
    if g == 0:
        return turned(np.array([0, 0, 1.0]), 2 * u - 1, turns)
    cosine = (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * u)) ** 2) / (2 * g)
    return turned(axis, cosine, turns)


def turned(axis, cosine: float, turns: float):
    """That angle away from ``axis``, about it from where Duff et al. 2017 begin."""
    sign = math.copysign(1, axis[2])
    a = -1 / (sign + axis[2])
    b = axis[0] * axis[1] * a
    across = np.array([1 + sign * axis[0] ** 2 * a, sign * b, -sign * axis[0]])
    along = np.array([b, sign + axis[1] ** 2 * a, -axis[1]])
    angle, sine = 2 * math.pi * turns, math.sqrt(max(0, 1 - cosine**2))
    new = sine * math.cos(angle) * across + sine * math.sin(angle) * along + cosine * axis
    return new / np.linalg.norm(new)
