"""``rings``: layers of interlocked reflecting rings before a wall.

Source: Haines 1987; SPD 3.x ``rings.c``. An object is six pentagonal rings, each of five
cylinders and five spheres; layer k holds (k + 1) x (k + 1) objects.
"""

from __future__ import annotations

import math

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import SKY_BLUE, Vector
from simmpp.scene.spd.transform import rotation_x, rotation_z, transform

TUBE_RADIUS = 0.07412
DISTANCE = 1 / math.sin(math.pi / 8)
"""Distance between layers."""
COLOURS = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1), (1, 0, 1), (1, 1, 0))


def objects(size: int) -> int:
    """Number of objects: 60 per ring object, and the wall."""
    return 60 * (size * (size + 1) * (2 * size + 1) // 6) + 1


def nff(size: int) -> str:
    """NFF text of ``size`` layers of rings."""
    d = DISTANCE
    parts = [
        SPD.background(SKY_BLUE),
        SPD.view((-1, -d, 0.5), (-1, -d + 1, 0.5), (0, 0, 1)),
        *map(SPD.light, ((3, -d, 3), (-4, -d, 1), (2, -d, -4))),
        SPD.material((1, 1, 1), 1),
        SPD.polygon(_wall(size)),
    ]
    pentagons = _pentagons()
    for layer in range(size):
        y = d * (layer + 1)
        offsets = [2.0 * i - layer for i in range(layer + 1)]
        for z in offsets:
            for x in offsets:
                _object((x, y, z), pentagons, parts)
    return "".join(parts)


def _wall(size: int) -> list[Vector]:
    """A square that fills the view behind the last layer."""
    y = DISTANCE * (size + 1)
    half = 1.01 * (y + DISTANCE) * math.tan(math.pi / 8)
    return [
        (-1 + half, y, 0.5 + half),
        (-1 - half, y, 0.5 + half),
        (-1 - half, y, 0.5 - half),
        (-1 + half, y, 0.5 - half),
    ]


def _pentagons() -> list[list[Vector]]:
    """Six rings about the origin, arranged as the faces of half a dodecahedron."""
    radius = 1 / (1 + TUBE_RADIUS)
    angles = [i * 2 * math.pi / 5 for i in range(5)]
    first: list[Vector] = [(radius * math.cos(a), radius * math.sin(a), 0.0) for a in angles]
    tilt = rotation_x(2 * math.acos(math.cos(math.pi / 3) / math.sin(math.pi / 5)))
    turns = [rotation_z(math.pi * (2 * k + 1) / 5) for k in range(5)]
    return [first] + [[transform(transform(v, tilt), turn) for v in first] for turn in turns]


def _object(centre: Vector, pentagons: list[list[Vector]], parts: list[str]) -> None:
    for colour, pentagon in zip(COLOURS, pentagons, strict=True):
        parts.append(SPD.material(colour, 0.5, 0.2, 3.0827))
        points = [(x + centre[0], y + centre[1], z + centre[2]) for x, y, z in pentagon]
        for i, point in enumerate(points):
            parts.append(SPD.cone(point, TUBE_RADIUS, points[i - 1], TUBE_RADIUS))
            parts.append(SPD.sphere(point, TUBE_RADIUS))
