"""``jacks``: nested jacks, crosses of reflecting cylinders tipped with spheres.

Source: SPD 3.x ``jacks.c`` (Haines).
"""

from __future__ import annotations

import itertools
import math

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import Vector
from simmpp.scene.spd.transform import (
    Matrix,
    product,
    rotation_x,
    rotation_y,
    scaling,
    transform,
    translation,
)

JACK_SCALE = 0.75
CYLINDER_RADIUS = 0.1
SPHERE_RADIUS = 0.2
AXES: tuple[Vector, ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def objects(size: int) -> int:
    """Number of objects: three cylinders and six spheres per jack."""
    return int((8**size - 1) // 7 * 9)


def nff(size: int) -> str:
    """NFF text of ``size`` levels of jacks."""
    parts = [
        SPD.background((0.2, 0.05, 0.2)),
        SPD.view((0, 0, -8), (0, 0, 0), (0, 1, 0), 25, 0.001, (256, 256)),
        SPD.light((-10, 3, -20)),
        SPD.material((0.737, 0.561, 0.561), 0.7, 0.7, 11.1434, ior=1),
    ]
    frame = product(rotation_y(math.radians(-20)), rotation_x(math.radians(-30)))
    _jacks(frame, 1.0, size, parts)
    return "".join(parts)


def _jacks(frame: Matrix, scale: float, depth: int, parts: list[str]) -> None:
    parts.extend(_jack(product(scaling(JACK_SCALE), frame), scale * JACK_SCALE))
    if depth == 1:
        return
    for corner in itertools.product((-0.5, 0.5), repeat=3):
        child = product(scaling(0.5), translation(*corner))
        _jacks(product(child, frame), scale / 2, depth - 1, parts)


def _jack(frame: Matrix, scale: float) -> list[str]:
    tips = [transform(axis, frame) for axis in AXES]
    tails = [transform((-x, -y, -z), frame) for x, y, z in AXES]
    radius = CYLINDER_RADIUS * scale
    return [
        *(SPD.cone(a, radius, b, radius) for a, b in zip(tails, tips, strict=True)),
        *(SPD.sphere(tip, SPHERE_RADIUS * scale) for tip in tips + tails),
    ]
