"""``tree``: a branching tree of truncated cones and spheres, lit by seven lights.

Source: Haines 1987 (after Aono and Kunii, 1984); SPD 3.x ``tree.c``.
"""

from __future__ import annotations

import math

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import SKY_BLUE
from simmpp.scene.spd.transform import (
    IDENTITY,
    Matrix,
    product,
    rotation_x,
    rotation_z,
    scaling,
    transform,
    translation,
)

BRANCH_RADIUS = 0.15
TAPER = 0.67
BRANCHES = ((40, 90, 0.65), (25, 230, 0.70))
"""(branching angle, turn about the trunk, length) of the two children, angles in degrees."""
LIGHTS = (
    (-5, 5, 50),
    (30, -30, 30),
    (-40, -30, 20),
    (10, 30, 40),
    (-30, 40, 10),
    (50, 25, 20),
    (-10, -60, 30),
)


def objects(size: int) -> int:
    """Number of objects: a cone and a sphere per branch, and the field."""
    return int(2 * (2 ** (size + 1) - 1) + 1)


def nff(size: int) -> str:
    """NFF text of the tree of ``size`` + 1 generations of branches."""
    parts = [
        SPD.background(SKY_BLUE),
        SPD.view((4.5, 0.4, 2), (0, 0, 1.5), (0, 0, 1)),
        *map(SPD.light, LIGHTS),
        SPD.material((0.2, 0.7, 0.2), 1),
        SPD.polygon(((50, 50, 0), (-50, 50, 0), (-50, -50, 0), (50, -50, 0))),
        SPD.material((0.55, 0.4, 0.2), 1),
    ]
    _branch(IDENTITY, 1.0, size, [_child(*branch) for branch in BRANCHES], parts)
    return "".join(parts)


def _child(tilt_degrees: float, turn_degrees: float, length: float) -> Matrix:
    """From a child branch's frame into its parent's."""
    tilt = rotation_x(math.radians(tilt_degrees))
    turn = rotation_z(math.radians(turn_degrees))
    return product(product(product(tilt, turn), scaling(length)), translation(0, 0, 1))


def _branch(
    frame: Matrix, scale: float, depth: int, children: list[Matrix], parts: list[str]
) -> None:
    base, tip = transform((0, 0, 0), frame), transform((0, 0, 1), frame)
    radius = scale * BRANCH_RADIUS
    tip_radius = radius * TAPER
    parts.append(SPD.cone(base, radius, tip, tip_radius))
    parts.append(SPD.sphere(tip, tip_radius))
    if depth > 0:
        for child in children:
            _branch(product(child, frame), scale * TAPER, depth - 1, children, parts)
