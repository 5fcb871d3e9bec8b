"""The frame in which a scene is traced: at the origin and of size one, whatever its units.

float32 holds a normalised scene as well as it can hold any, and a scene moved by an offset that
its coordinates can bear is traced to the same bits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import SceneError
from simmpp.scene.columns import CONE, POLYGON, SPHERE, Columns, columns_of
from simmpp.scene.scene import Scene

Floats = NDArray[np.float64]

EXPONENT_LIMIT = 900
"""Scenes larger than 2 to this, or smaller than its inverse, would lose digits of their distances
to overflow or to subnormal numbers."""
GRID = 2.0**-32
"""Step of rounded lengths, normalised: a million roundings of float64, and far below any object."""


@dataclass(frozen=True, eq=False)
class Frame:
    """Maps scene units to normalised ones: subtract an input coordinate, scale by a power of two.

    Both steps are exact wherever the scene's own coordinates allow it.
    """

    origin: Floats
    """(3,) float64, in scene units: per axis the least input coordinate."""
    scale: float
    """A power of two; the normalised extent is at most 1."""

    def points(self, points: Floats) -> Floats:
        """(..., 3) float64 in scene units, normalised."""
        return (np.asarray(points, dtype=np.float64) - self.origin) * self.scale

    def rounded(self, lengths: Floats) -> Floats:
        """Lengths in scene units to the nearest GRID: what is equal but for roundings is equal."""
        return np.rint(lengths * (self.scale / GRID)) * (GRID / self.scale)

    def scene_lengths(self, lengths: Floats) -> Floats:
        """Normalised lengths in scene units, exact; infinity stays."""
        return lengths / self.scale


def frame_of(scene: Scene) -> Frame:
    """The frame of all objects of ``scene``.

    Raises
    ------
    SceneError
        A coordinate or radius is not finite, or the scene is too large or too small for float64.
    """
    if not scene.objects:
        return Frame(np.zeros(3), 1.0)
    points, radii = _ends(columns_of(scene))
    bad = ~(np.isfinite(points).all(axis=(1, 2)) & np.isfinite(radii))
    if bad.any():
        problem = f"object {bad.argmax()} has a coordinate that is not finite"
        raise SceneError(problem, where=scene.name)
    origin, reach = points[:, 0].min(axis=0), radii[:, None]
    with np.errstate(over="ignore"):
        high = (points[:, 1] - origin + reach).max(axis=0)
        low = (points[:, 0] - origin - reach).min(axis=0)
        extent = float((high - low).max())
    # A power of two changes exponents only, so distances go back to scene units without an error.
    _, exponent = math.frexp(extent)
    if not (math.isfinite(extent) and abs(exponent) <= EXPONENT_LIMIT):
        limits = f"expected 0, or from {2.0**-EXPONENT_LIMIT:.0e} to {2.0**EXPONENT_LIMIT:.0e}"
        raise SceneError(f"the scene's extent is {extent:g}: {limits}", where=scene.name)
    return Frame(origin, math.ldexp(1.0, -exponent))


def _ends(objects: Columns) -> tuple[Floats, Floats]:
    """The least and the greatest input coordinates, (N, 2, 3), and radii around them, (N,).

    Of numbers of which one is not finite, one of both is not.
    """
    points, radii = np.empty((len(objects.kinds), 2, 3)), np.zeros(len(objects.kinds))
    spheres, cones, flat = objects.kinds == SPHERE, objects.kinds == CONE, objects.kinds >= POLYGON
    points[spheres], radii[spheres] = objects.spheres[:, None, :3], np.abs(objects.spheres[:, 3])
    base, base_radius, apex, apex_radius = np.split(objects.cones, (3, 4, 7), axis=1)
    points[cones, 0], points[cones, 1] = np.minimum(base, apex), np.maximum(base, apex)
    radii[cones] = np.maximum(np.abs(base_radius), np.abs(apex_radius))[:, 0]
    if flat.any():
        sizes = objects.n_vertices[flat]
        starts = np.cumsum(sizes) - sizes
        points[flat, 0] = np.minimum.reduceat(objects.vertices, starts)
        points[flat, 1] = np.maximum.reduceat(objects.vertices, starts)
    return points, radii
