"""How a particle goes on: born, to the next collision or the next side of its cell, scattered.

Numbers are drawn by counting (Philox, keyed by the seed and the root): a function of the root, the
branch of its tree, the event along it, and the dimension.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from simmpp.common.compiled import kernel
from simmpp.scene.scene import Vector
from simmpp.workload.particles.functions import log_of, on_circle
from simmpp.workload.particles.grid import BEAM, COSINE, ONE, Grid
from simmpp.workload.trace.path.philox import philox
from simmpp.workload.trace.vectors import basis_across, moved, normalised, times, vector

Place = tuple[int, int, int]
Four = tuple[float, float, float, float]


class Particle(NamedTuple):
    """One that flies."""

    position: Vector
    direction: Vector
    place: Place
    """Its cell, along x, y and z."""
    weight: int
    ahead: float
    """Optical depth to its next collision."""
    branch: int
    event: int


@kernel
def draw(seed: int, root: int, branch: int, event: int, dimension: int) -> Four:
    """Four numbers above 0 and below 1."""
    key = np.uint64(seed), np.uint64(root)
    counter = np.uint64(event), np.uint64(dimension), np.uint64(branch), np.uint64(0)
    a, b, c, d = philox(key, counter)
    return _between(a), _between(b), _between(c), _between(d)


@kernel
def _between(word: np.uint64) -> float:
    return (float(np.int64(word)) + 0.5) * 2.0**-32


@kernel
def emitted(grid: Grid, seed: int, root: int) -> Particle:
    """What the source sends off as root number ``root``."""
    a, b, c, _ = draw(seed, root, 0, 0, 0)
    u, v, w, _ = draw(seed, root, 0, 0, 1)
    low, high, aim = vector(grid.corners, 0), vector(grid.corners, 1), vector(grid.corners, 2)
    x, y, z = (
        low[0] + a * (high[0] - low[0]),
        low[1] + b * (high[1] - low[1]),
        low[2] + c * (high[2] - low[2]),
    )
    i, j, k = int(x / grid.widths[0]), int(y / grid.widths[1]), int(z / grid.widths[2])
    place = min(i, grid.shape[0] - 1), min(j, grid.shape[1] - 1), min(k, grid.shape[2] - 1)
    direction = aim
    if grid.emits == COSINE:
        direction = turned(aim, math.sqrt(u), v)
    elif grid.emits != BEAM:
        direction = isotropic(u, v)
    return Particle((x, y, z), direction, place, ONE, -log_of(w), 0, 0)


@kernel
def isotropic(u: float, turns: float) -> Vector:
    """Any direction alike."""
    cosine = 2.0 * u - 1.0
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    c, s = on_circle(turns)
    return sine * c, sine * s, cosine


@kernel
def scattered(direction: Vector, g: float, u: float, turns: float) -> Vector:
    """A direction by the law of Henyey and Greenstein 1941 about another."""
    if g == 0.0:
        return isotropic(u, turns)
    share = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
    cosine = (1.0 + g * g - share * share) / (2.0 * g)
    return turned(direction, min(1.0, max(-1.0, cosine)), turns)


@kernel
def turned(axis: Vector, cosine: float, turns: float) -> Vector:
    """The direction at that angle to ``axis``, so many turns about it."""
    across, along = basis_across(axis)
    c, s = on_circle(turns)
    sine = math.sqrt(max(0.0, 1.0 - cosine * cosine))
    aside = moved(times(sine * c, across), sine * s, along)
    return normalised(moved(aside, cosine, axis))


@kernel
def side_ahead(grid: Grid, particle: Particle) -> tuple[float, int]:
    """How far the cell's side is in the particle's direction, and which it is."""
    nearest, side = np.inf, 0
    for axis in range(3):
        towards = particle.direction[axis]
        if towards != 0.0:
            up = 1 if towards > 0.0 else 0
            plane = (particle.place[axis] + up) * grid.widths[axis]
            distance = (plane - particle.position[axis]) / towards
            if distance < nearest:
                nearest, side = distance, 2 * axis + up
    return max(0.0, nearest), side


@kernel
def crossed(grid: Grid, particle: Particle, distance: float, side: int) -> tuple[Particle, bool]:
    """The particle beyond that side, or mirrored by it; False if it has left the cells."""
    axis, up = side // 2, side % 2
    position, direction, place = particle.position, particle.direction, particle.place
    plane = (place[axis] + up) * grid.widths[axis]
    position = _with(moved(position, distance, direction), axis, plane)
    index, stays = place[axis] + 2 * up - 1, True
    if index < 0 or index >= grid.shape[axis]:
        stays = grid.mirrors[side]
        direction = _with(direction, axis, -direction[axis])
    else:
        place = _with(place, axis, index)
    ahead = particle.ahead - distance * sigma_of(grid, particle.place)
    weight, branch, event = particle.weight, particle.branch, particle.event
    return Particle(position, direction, place, weight, ahead, branch, event), stays


@kernel
def _with(a: Any, axis: int, value: Any) -> Any:
    """Three numbers, one of them another."""
    return (
        value if axis == 0 else a[0],
        value if axis == 1 else a[1],
        value if axis == 2 else a[2],
    )


@kernel
def sigma_of(grid: Grid, place: Place) -> float:
    """Collisions per unit of length in a cell."""
    return grid.materials[grid.material_of[cell_of(grid, place)], 0]


@kernel
def cell_of(grid: Grid, place: Place) -> int:
    """The number of a cell."""
    return place[0] + grid.shape[0] * (place[1] + grid.shape[1] * place[2])
