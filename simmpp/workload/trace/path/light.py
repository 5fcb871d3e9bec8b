"""One light sample per hit: which light, which point of it, and what comes from there.

A point lights as brightly wherever it is, as in Whitted's pictures. A triangle is chosen by its
power and its points are chosen evenly; it shines to both sides.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from simmpp.common.compiled import kernel
from simmpp.scene.scene import Vector
from simmpp.workload.trace.exact import Floats, row_of
from simmpp.workload.trace.geometry import Shapes
from simmpp.workload.trace.path.philox import numbers
from simmpp.workload.trace.path.rules import Paths
from simmpp.workload.trace.surface import Surface
from simmpp.workload.trace.vectors import cross, dot, minus, moved, normalised, times, vector

LIGHT = 1
"""Dimension of the numbers of a light sample."""
BEFORE = 1.0 - 2.0**-20
"""Share of the way to a lamp that has to be free: at its end is the lamp itself."""


class Sample(NamedTuple):
    """A point of a light as a surface sees it."""

    direction: Vector
    """Of length 1."""
    limit: float
    """The way that has to be free; 0 where no light can come from there."""
    light: Vector
    """Red, green and blue that a white matt surface sends on, if the way is free."""


@kernel
def sample_of(
    paths: Paths, shapes: Shapes, hit: int, surface: Surface, root: int, event: int
) -> Sample:
    """The light sample of a hit on object ``hit``."""
    lamps, black = paths.lamps, (0.0, 0.0, 0.0)
    n_points = len(lamps.points)
    n = n_points + (1 if len(lamps.rows) else 0)
    if n == 0 or paths.materials[paths.material_of[hit], 3] <= 0.0:
        return Sample(surface.normal, 0.0, black)
    choice, power, u, v = numbers(paths.seed, root, event, LIGHT)
    k = min(int(choice * n), n - 1)
    if k == n_points:
        return _of_triangle(paths, shapes, surface, float(n), (power, u, v))
    to_light = minus(vector(lamps.points, k), surface.point)
    distance = math.sqrt(dot(to_light, to_light))
    if not (distance > 0.0 and dot(surface.normal, to_light) > 0.0):
        return Sample(surface.normal, 0.0, black)
    direction = normalised(to_light)
    bright = n * dot(surface.normal, direction)
    return Sample(direction, distance, times(bright, vector(lamps.point_colours, k)))


@kernel
def _of_triangle(
    paths: Paths, shapes: Shapes, surface: Surface, n: float, chance: Vector
) -> Sample:
    """A point of a triangle that shines, chosen for one light among ``n``."""
    (power, u, v), lamps, black = chance, paths.lamps, (0.0, 0.0, 0.0)
    total = lamps.powers[-1]
    k = _place_of(lamps.powers, power * total)
    row = row_of(shapes.surfaces, lamps.rows[k])
    if u + v > 1.0:  # the other half of the parallelogram, folded back
        u, v = 1.0 - u, 1.0 - v
    across = cross(row[3:6], row[6:])
    point = moved(moved(row[:3], u, row[3:6]), v, row[6:])
    to_light = minus(point, surface.point)
    square = dot(to_light, to_light)
    if not (square > 0.0 and total > 0.0 and dot(surface.normal, to_light) > 0.0):
        return Sample(surface.normal, 0.0, black)
    distance, direction = math.sqrt(square), normalised(to_light)
    slant = abs(dot(across, direction)) / math.sqrt(dot(across, across))
    material = paths.materials[paths.material_of[lamps.objects[k]]]
    red, green, blue = material[6], material[7], material[8]
    # Its points are as likely as they are bright: per area, brightness / total.
    share = n * total / (math.pi * max(red, green, blue))
    bright = share * slant * dot(surface.normal, direction) / square
    return Sample(direction, distance * BEFORE, times(bright, (red, green, blue)))


@kernel
def _place_of(sums: Floats, value: float) -> int:
    """The first entry above ``value``, at most the last."""
    low, high = 0, len(sums) - 1
    while low < high:
        middle = (low + high) // 2
        if sums[middle] > value:
            high = middle
        else:
            low = middle + 1
    return low
