"""``lattice``: a cubic grid of reflecting spheres joined by coloured cylinders.

Source: SPD 3.x ``lattice.c`` (Haines).
"""

from __future__ import annotations

import math
from itertools import product

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import SKY_BLUE

SPHERE = SPD.material((0.9, 0.9, 0.9), 0.5, 0.5, 3.0827)
CYLINDERS = tuple(
    SPD.material(colour, 0.99) for colour in ((0.9, 0.1, 0.1), (0.1, 0.9, 0.1), (0.1, 0.1, 0.9))
)
LIGHTS = (
    (2, 0.5, 0.5),
    (-1, 0.5, 0.5),
    (0.5, 2, 0.5),
    (0.5, -1, 0.5),
    (0.5, 0.5, 2),
    (0.5, 0.5, -1),
)


def objects(size: int) -> int:
    """Number of objects: a sphere per grid point, a cylinder per edge of the grid."""
    return (size + 1) ** 3 + 3 * size * (size + 1) ** 2


def nff(size: int) -> str:
    """NFF text of the lattice of size x size x size cells."""
    n = size
    x0 = (n // 2 + 0.5) / n
    parts = [
        SPD.background(SKY_BLUE),
        SPD.view((x0, 1, 1 - 1 / (2 * n)), (x0, -1, -1 - 1 / (2 * n)), (0.2, 1, 0), 60, hither=0),
        *map(SPD.light, LIGHTS),
    ]
    for cell in product(range(n + 1), range(n + 1), range(n + 1)):
        parts.extend(_grid_point(n, cell))
    return "".join(parts)


def _grid_point(n: int, cell: tuple[int, int, int]) -> list[str]:
    """The sphere at a grid point and its cylinders towards +x, +y and +z."""
    radius, tube = 1 / (4 * n), 1 / (16 * n)
    # Cylinders end just inside the spheres, whatever the SPD's radii.
    pulled = 0.99 * radius * (1 - math.sqrt(1 / 4))
    centre = tuple(c / n for c in cell)
    lines = [SPHERE, SPD.sphere(centre, radius)]
    for axis in range(3):
        if cell[axis] < n:
            near, far = list(centre), list(centre)
            near[axis] += pulled
            far[axis] += 1 / n - pulled
            lines += [CYLINDERS[axis], SPD.cone(near, tube, far, tube)]
    return lines
