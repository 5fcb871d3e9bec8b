"""``mountain`` (the SPD's ``mount``): a fractal height field under four glass spheres.

Source: Haines 1987; SPD 3.x ``mount.c``. The deterministic "Gaussian" of a grid point keeps the
SPD's well-known faulty hash, which uses X twice and Y once: published results were made with it.
"""

from __future__ import annotations

import math

from simmpp.scene.nff_text import SPD
from simmpp.scene.scene import SKY_BLUE, Vector
from simmpp.scene.spd.transform import product, rotation_about, rotation_z, transform

BALL_RADIUS = 0.17
FRACTAL_DIMENSION = 2.2
ROUGHNESS = math.sqrt((2 / math.exp(math.log(2) / (FRACTAL_DIMENSION - 1))) ** 2 - 1)
DIAGONAL = 1.4142136
"""The SPD's constant for sqrt(2): more digits would move the last one printed."""
SEED = 21


def objects(size: int) -> int:
    """Number of objects: two triangles per cell of the height field, and the spheres."""
    return 2 * 4**size + 4


def nff(size: int) -> str:
    """NFF text of the mountain of 2**size x 2**size cells; sizes 1 to 7 are nested."""
    parts = [
        SPD.background(SKY_BLUE),
        SPD.view((-1.6, 1.6, 1.7), (0, 0, 0), (0, 0, 1), hither=0.01),
        SPD.light((-100, -100, 100)),
        SPD.material((1, 1, 1), 0.1, 0.1, 101.148, 0.9, 1.5),
        *(SPD.sphere(centre, BALL_RADIUS) for centre in _ball_centres()),
        SPD.material((0.5, 0.45, 0.35), 1),
    ]
    _Terrain(size, parts).build()
    return "".join(parts)


def _ball_centres() -> list[Vector]:
    """Corners of a regular tetrahedron, so that the balls touch each other."""
    top: Vector = (0, 0, BALL_RADIUS * math.sqrt(1.5))
    axis = (1 / math.sqrt(2), 1 / math.sqrt(2), 0)
    tilt = rotation_about(axis, math.acos(-1 / 3))
    turns = [product(tilt, rotation_z(k * 2 * math.pi / 3)) for k in range(3)]
    offsets = [top, *(transform(top, turn) for turn in turns)]
    return [(x - 0.8, y + 0.8, z + 1.0) for x, y, z in offsets]


def _gaussian(seed: int) -> float:
    """The SPD's normal deviate of a seed: polar method over a small congruential generator."""
    j = seed
    while True:
        i = (28411 + 8121 * j) % 134456
        j = (28411 + 8121 * i) % 134456
        a = i * 2 / 134456 - 1
        b = j * 2 / 134456 - 1
        r = a * a + b * b
        if r < 1:
            return a * math.sqrt(-2 * math.log(r) / r)


class _Terrain:
    """Midpoint displacement of a square, quadrant by quadrant, into triangles."""

    def __init__(self, size: int, parts: list[str]) -> None:
        self.size = size
        self.cells = 2**size
        self.parts = parts
        self.deviates: dict[tuple[int, int], float] = {}
        self.ticks = [f"{-1 + i * 2 / self.cells:g}" for i in range(self.cells + 1)]

    def build(self) -> None:
        """Write all triangles; the four corners of the square are at height 0."""
        self._square(0, 0, self.cells, 0.0, 0.0, 0.0, 0.0)

    def _deviate(self, x: int, y: int) -> float:
        """Normal deviate of a grid point: neighbours agree, so there are no cracks."""
        if (x, y) not in self.deviates:
            n = self.size
            hashed = ((x << 23 - n) + (y << 15 - n) + (x << 7 - n)) & 0xFFFF
            self.deviates[x, y] = _gaussian(SEED + hashed)
        return self.deviates[x, y]

    def _square(
        self, x: int, y: int, width: int, ll: float, lr: float, ur: float, ul: float
    ) -> None:
        """Displace the middles of a square of corner heights ll, lr, ur, ul; recurse."""
        if width == 1:
            self._cell(x, y, ll, lr, ur, ul)
            return
        half = width // 2
        rise = half * 2 / self.cells * ROUGHNESS
        mx, my = x + half, y + half
        low = (ll + lr) / 2 + rise * self._deviate(mx, y)
        right = (lr + ur) / 2 + rise * self._deviate(x + width, my)
        high = (ur + ul) / 2 + rise * self._deviate(mx, y + width)
        left = (ul + ll) / 2 + rise * self._deviate(x, my)
        mid = (ll + lr + ur + ul) / 4 + DIAGONAL * rise * self._deviate(mx, my)
        self._square(x, y, half, ll, low, mid, left)
        self._square(mx, y, half, low, lr, right, mid)
        self._square(mx, my, half, mid, right, ur, high)
        self._square(x, my, half, left, mid, high, ul)

    def _cell(self, x: int, y: int, ll: float, lr: float, ur: float, ul: float) -> None:
        x0, x1, y0, y1 = (self.ticks[i] for i in (x, x + 1, y, y + 1))
        lower_left = f"{x0} {y0} {ll:g}\n"
        upper_right = f"{x1} {y1} {ur:g}\n"
        self.parts.append(
            f"p 3\n{lower_left}{x1} {y0} {lr:g}\n{upper_right}"
            f"p 3\n{upper_right}{x0} {y1} {ul:g}\n{lower_left}"
        )
