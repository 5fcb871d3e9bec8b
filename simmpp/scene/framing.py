"""A camera and lights for objects that come without: a three-quarter view of all of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from simmpp.scene.scene import Camera, Floats, Light, Vector

ANGLE_DEGREES = 45.0
ROOM = 1.05
"""The bounding sphere fills the view but for this factor. ESTIMATE."""


def framing(bounds: Floats, *, up: Vector) -> tuple[Camera, tuple[Light, ...]]:
    """Camera and lights that show everything within ``bounds`` (2, 3) float64.

    The eye looks down at the centre from front right, far enough for the bounding sphere to be in
    view; a light stands above left of the eye, another far to the right. ``up`` is +y or +z.
    """
    centre = (bounds[0] + bounds[1]) / 2
    radius = math.dist(bounds[0], bounds[1]) / 2
    above = np.array(up)
    # y up: front is +z, right is +x; z up: front is -y, right is +x.
    right = np.array([1.0, 0.0, 0.0])
    front = np.cross(right, above)
    towards_eye = _unit(0.6 * right + front + 0.55 * above)
    distance = ROOM * radius / math.sin(math.radians(ANGLE_DEGREES) / 2)
    eye = centre + distance * towards_eye
    lights = (
        centre + 2 * distance * _unit(front - 0.4 * right + 1.2 * above),
        centre + 2 * distance * _unit(right + 0.3 * front + 0.6 * above),
    )
    camera = Camera(_vector(eye), _vector(centre), up, ANGLE_DEGREES)
    return camera, tuple(Light(_vector(light)) for light in lights)


FAR_OFF = 1e6
"""Of a sun, in diagonals of the scene: its light is parallel to a millionth. ESTIMATE."""


def far_off(sun: Light, bounds: Floats) -> Light:
    """A point light for one of which only the way to it is known, as its ``position``."""
    centre = (bounds[0] + bounds[1]) / 2
    distance = FAR_OFF * math.dist(bounds[0], bounds[1])
    return replace(sun, position=_vector(centre + distance * _unit(np.array(sun.position))))


def _unit(v: Floats) -> Floats:
    unit: Floats = v / math.hypot(*v)
    return unit


def _vector(v: Floats) -> Vector:
    return float(v[0]), float(v[1]), float(v[2])
