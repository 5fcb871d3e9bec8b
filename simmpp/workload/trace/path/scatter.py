"""How a path goes on from a hit: matt, mirrored or through, or not at all, as chance has it.

A surface is Lambert's with the share that NFF's Kd and colour say, else a mirror (Ks) or glass (T).
From a given depth a path goes on with the probability p = min(0.95, greatest share) only, and
counts 1 / p times: Russian roulette (Arvo and Kirk 1990, "Particle transport and image synthesis").
"""

from __future__ import annotations

import math
from typing import NamedTuple

from simmpp.common.compiled import kernel
from simmpp.scene.scene import Vector
from simmpp.workload.trace.exact import Floats, Ray
from simmpp.workload.trace.path.philox import numbers
from simmpp.workload.trace.path.rules import Paths
from simmpp.workload.trace.surface import Surface, reflected, refracted
from simmpp.workload.trace.vectors import basis_across, moved, normalised, times
from simmpp.workload.workload import DIFFUSE, REFLECTED, REFRACTED

SURVIVORS = 0.95
"""At most so many of the paths go on: in a white room, too, they end."""
CHOICE, AIM = 0, 2
"""Dimensions: of the choices, and the first of those of a direction."""
NONE = -1


class Scatter(NamedTuple):
    """The ray that a path goes on with."""

    kind: int
    """NONE where the path ends."""
    direction: Vector


@kernel
def scatter_of(
    paths: Paths, hit: int, ior: float, ray: Ray, surface: Surface, root: int, depth: int
) -> Scatter:
    """Where a path goes from its hit of ``depth`` on object ``hit``."""
    material = paths.materials[paths.material_of[hit]]
    diffuse, mirrored = material[3], material[4]
    total = diffuse + mirrored + material[5]
    lobe, survival, _, _ = numbers(paths.seed, root, depth, CHOICE)
    ends = depth >= paths.depth or not survival < survivors(paths, total, depth)
    if ends or not total > 0.0:
        return Scatter(NONE, surface.normal)
    place = lobe * total
    if place < diffuse:
        return Scatter(DIFFUSE, _cosine(paths.seed, root, depth, surface.normal))
    if place >= diffuse + mirrored and paths.refraction:
        passes, direction = refracted(ray, surface, ior)
        if passes:
            return Scatter(REFRACTED, direction)
    elif place >= diffuse + mirrored:
        return Scatter(NONE, surface.normal)
    # What total reflection keeps from passing is mirrored.
    kind = REFLECTED if paths.reflection else NONE
    return Scatter(kind, reflected(ray, surface))


@kernel
def survivors(paths: Paths, total: float, depth: int) -> float:
    """Probability that a path goes on from a hit of that depth; 1 before the roulette."""
    return min(SURVIVORS, total) if depth >= paths.roulette else 1.0


@kernel
def weight_of(paths: Paths, material: Floats, kind: int, depth: int) -> Vector:
    """What counts of the light that a ray of ``kind`` brings to a hit of ``depth``."""
    total = material[3] + material[4] + material[5]
    weight = total / survivors(paths, total, depth)
    if kind != DIFFUSE:
        return weight, weight, weight
    return times(weight / material[3], (material[0], material[1], material[2]))


@kernel
def _cosine(seed: int, root: int, event: int, normal: Vector) -> Vector:
    """A direction by Lambert's cosine: above an even point of the disc (Malley's method)."""
    dimension = AIM
    x, y, s = 0.0, 0.0, 2.0
    while s >= 1.0:  # a square without its corners, as a sine is not the same on every computer
        a, b, c, d = numbers(seed, root, event, dimension)
        x, y = 2.0 * a - 1.0, 2.0 * b - 1.0
        s = x * x + y * y
        if s >= 1.0:
            x, y = 2.0 * c - 1.0, 2.0 * d - 1.0
            s = x * x + y * y
        dimension += 1
    across, along = basis_across(normal)
    return normalised(moved(moved(times(math.sqrt(1.0 - s), normal), x, across), y, along))
