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
from simmpp.scene.scene import Cone, Scene, SceneObject, Sphere

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
    parts = [_input_coordinates(thing) for thing in scene.objects]
    counts = [len(points) for points, _ in parts]
    points = np.concatenate([points for points, _ in parts])
    radii = np.repeat([abs(radius) for _, radius in parts], counts)[:, None]
    _require_finite(scene.name, counts, np.hstack([points, radii]))
    origin = points.min(axis=0)
    with np.errstate(over="ignore"):
        extent = float(((points - origin + radii).max(0) - (points - origin - radii).min(0)).max())
    # A power of two changes exponents only, so distances go back to scene units without an error.
    _, exponent = math.frexp(extent)
    if not (math.isfinite(extent) and abs(exponent) <= EXPONENT_LIMIT):
        limits = f"expected 0, or from {2.0**-EXPONENT_LIMIT:.0e} to {2.0**EXPONENT_LIMIT:.0e}"
        raise SceneError(f"the scene's extent is {extent:g}: {limits}", where=scene.name)
    return Frame(origin, math.ldexp(1.0, -exponent))


def _input_coordinates(thing: SceneObject) -> tuple[Floats, float]:
    """Points (k, 3) float64 that describe an object, and the largest radius around them."""
    if isinstance(thing, Sphere):
        return np.array([thing.centre], dtype=np.float64), thing.radius
    if isinstance(thing, Cone):
        radius = float(np.abs([thing.base_radius, thing.apex_radius]).max())  # NaN if one is
        return np.array([thing.base, thing.apex], dtype=np.float64), radius
    return np.asarray(thing.vertices, dtype=np.float64), 0.0


def _require_finite(name: str, counts: list[int], coordinates: Floats) -> None:
    bad = ~np.isfinite(coordinates).all(axis=1)
    if bad.any():
        number = int(np.repeat(np.arange(len(counts)), counts)[bad.argmax()])
        raise SceneError(f"object {number} has a coordinate that is not finite", where=name)
