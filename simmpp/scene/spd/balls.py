"""``balls``: the sphereflake, reflecting spheres that carry nine smaller ones each.

Source: Haines 1987; SPD 3.x ``balls.c``.
"""

from __future__ import annotations

import math

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import SKY_BLUE, Vector
from simmpp.scene.spd.transform import (
    IDENTITY,
    Matrix,
    rotation_about,
    rotation_y,
    rotation_z,
    transform,
)

PARALLEL = 0.9999
"""Cosine from which a direction counts as the z axis itself, as in the SPD."""


def objects(size: int) -> int:
    """Number of objects: spheres of size + 1 generations, and the floor."""
    return int((9 ** (size + 1) - 1) // 8 + 1)


def nff(size: int) -> str:
    """NFF text of the sphereflake of ``size`` + 1 generations."""
    parts = [
        SPD.background(SKY_BLUE),
        SPD.view((2.1, 1.3, 1.7), (0, 0, 0), (0, 0, 1), hither=0.01),
        *map(SPD.light, ((4, 3, 2), (1, -4, 4), (-3, 1, 5))),
        SPD.material((1, 0.75, 0.33), 0.8, ior=1),
        SPD.polygon(((12, 12, -0.5), (-12, 12, -0.5), (-12, -12, -0.5), (12, -12, -0.5))),
        SPD.material((1, 0.9, 0.7), 0.5, 0.5, 3.0827, ior=1),
    ]
    _flake(size, (0.0, 0.0, 0.0), 0.5, (0.0, 0.0, 1.0), _nine_directions(), parts)
    return "".join(parts)


def _nine_directions() -> list[Vector]:
    """Where the children of a sphere with direction +z sit."""
    c = 1 / math.sqrt(2)
    tilt = rotation_about((c, -c, 0), math.asin(2 / math.sqrt(6)))
    three = [transform(v, tilt) for v in ((c, c, 0), (c, 0, -c), (0, c, -c))]
    turns = [rotation_z(k * 2 * math.pi / 3) for k in range(3)]
    return [transform(v, turn) for turn in turns for v in three]


def _from_z_to(direction: Vector) -> Matrix:
    """The rotation that takes +z to ``direction``."""
    x, y, z = direction
    if z >= PARALLEL:
        return IDENTITY
    if z <= -PARALLEL:
        return rotation_y(math.pi)
    length = math.sqrt(x * x + y * y)
    return rotation_about((-y / length, x / length, 0), math.acos(z))


def _flake(
    depth: int,
    centre: Vector,
    radius: float,
    direction: Vector,
    nine: list[Vector],
    parts: list[str],
) -> None:
    parts.append(SPD.sphere(centre, radius))
    if depth == 0:
        return
    turn = _from_z_to(direction)
    reach = radius * (4 / 3)
    for v in nine:
        # The direction is taken back from the rounded child, and thirds are products with a rounded
        # 1/3, as in the SPD: its files print the digits in which these differ.
        (x, y, z), (dx, dy, dz) = centre, transform(v, turn)
        child = (x + dx * reach, y + dy * reach, z + dz * reach)
        towards = ((child[0] - x) / reach, (child[1] - y) / reach, (child[2] - z) / reach)
        _flake(depth - 1, child, radius * (1 / 3), towards, nine, parts)
