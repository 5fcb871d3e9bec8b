"""``gears``: interlocked gears, 144-gons that are concave, one in five of them transparent.

Source: Haines 1987; SPD 3.x ``gears.c``.
"""

from __future__ import annotations

import math
from itertools import product

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import SKY_BLUE, Vector

TEETH = 36
PITCH = 2 * math.pi / TEETH
OVERLAP = 0.05
"""How far gears mesh, as a share of their radius."""
OUTER, INNER = 0.995, 0.9
TOOTH = ((-0.19, OUTER), (0.19, OUTER), (0.3, INNER), (0.7, INNER))
"""(angle in pitches, radius) of the four vertices of a tooth."""
LIGHTS = ((2, 4, 4), (-2, 4, 3), (2, -2.5, 2.5), (-1, -4, 2), (-1.111, -2.121, 2.626))


def objects(size: int) -> int:
    """Number of objects: 144 sides and two faces per gear, and the ground."""
    return (4 * TEETH + 2) * size**3 + 1


def nff(size: int) -> str:
    """NFF text of size x size x size gears."""
    parts = [
        SPD.background(SKY_BLUE),
        SPD.view((-1.1, -2.1, 2.6), (0, 0, 0), (0, 0, 1)),
        *map(SPD.light, LIGHTS),
        SPD.material((1, 0.85, 0.7), 0.3, 0.6, 3.0827),
        SPD.polygon(((2, 2, 0), (-2, 2, 0), (-2, -2, 0), (2, -2, 0))),
    ]
    for iz, iy, ix in product(range(size), repeat=3):
        parts.append(_material(ix, iy, iz))
        parts.extend(_gear(size, ix, iy, iz))
    return "".join(parts)


def _material(ix: int, iy: int, iz: int) -> str:
    # (k * 5) / 7, not k * (5 / 7): the fraction jumps at multiples of 7.
    raw = (
        math.fmod((3 * ix + 2 * iy + iz + 1) * 5 / 7, 1) + 0.01,
        math.fmod((3 * iy + 2 * iz + ix + 1) * 3 / 7, 1) + 0.01,
        math.fmod((3 * iz + 2 * ix + iy + 1) * 2 / 7, 1) + 0.01,
    )
    largest = max(raw)
    colour = [c / largest for c in raw]
    if (4 * ix + 2 * iy + iz) % 5 == 0:
        return SPD.material(colour, 0.2, 0, 100000, 0.8, 1.1)
    return SPD.material(colour, 1)


def _gear(size: int, ix: int, iy: int, iz: int) -> list[str]:
    """Top face, sides and bottom face of one gear."""
    radius = 1 / (size - (size - 1) * OVERLAP)
    step = radius * 2 * (1 - OVERLAP)
    x, y = -1 + radius + ix * step, -1 + radius + iy * step
    z = 1 - iz / size
    floor = z - min(0.1, 1 / (2 * size))
    turn = PITCH / 2 if (ix + iy + iz) % 2 else 0.0

    def outline(sign: int, height: float) -> list[Vector]:
        corners = [
            (turn + sign * (tooth + at) * PITCH, share * radius)
            for tooth in range(TEETH)
            for at, share in TOOTH
        ]
        return [(x + r * math.cos(a), y + r * math.sin(a), height) for a, r in corners]

    top = outline(1, z)
    sides = [
        SPD.polygon((v, (v[0], v[1], floor), (w[0], w[1], floor), w))
        for v, w in zip(top, top[1:] + top[:1], strict=True)
    ]
    return [SPD.polygon(top), *sides, SPD.polygon(outline(-1, floor))]
