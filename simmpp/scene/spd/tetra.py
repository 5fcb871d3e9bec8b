"""``tetra``: Sierpinski's tetrahedron, 4**size triangles that neither reflect nor transmit.

Source: Haines 1987; SPD 3.x ``tetra.c``.
"""

from __future__ import annotations

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import SKY_BLUE, Vector

CORNERS = ((-1, -1, 1), (-1, 1, -1), (1, -1, -1), (1, 1, 1))
FACES = ((0, 1, 2), (3, 2, 1), (2, 3, 0), (1, 0, 3))


def objects(size: int) -> int:
    """Number of triangles."""
    return int(4**size)


def nff(size: int) -> str:
    """NFF text of the tetrahedron of 4**(size - 1) tetrahedra."""
    eye = (1.022846, -3.177154, -2.174512)
    at = (-0.004103, -0.004103, 0.216539)
    parts = [
        SPD.background(SKY_BLUE),
        SPD.view(eye, at, (-0.816497, -0.816497, 0.816497)),
        SPD.light((2, -18, -5)),
        SPD.material((1, 0.2, 0.2), 1),
    ]
    _tetrahedra((0.0, 0.0, 0.0), 1.0, size, parts)
    return "".join(parts)


def _tetrahedra(centre: Vector, half_width: float, depth: int, parts: list[str]) -> None:
    """Write the tetrahedra in the cube of that centre and half width."""
    x, y, z = centre
    reach = half_width / 2 if depth > 1 else half_width
    corners = [(x + reach * i, y + reach * j, z + reach * k) for i, j, k in CORNERS]
    if depth > 1:
        for corner in corners:
            _tetrahedra(corner, reach, depth - 1, parts)
        return
    lines = [SPD.numbers(*corner) + "\n" for corner in corners]
    parts.extend(f"p 3\n{lines[a]}{lines[b]}{lines[c]}" for a, b, c in FACES)
