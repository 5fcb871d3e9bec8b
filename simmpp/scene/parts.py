"""A file as one of several in a scene: where it is put, how it is turned and how large it is."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np

from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, Strict, Text, parsed_by
from simmpp.common.units import shown
from simmpp.scene.scene import Floats, Vector
from simmpp.scene.view import is_number, listed, three

_SCALE = "a number other than 0, or three of them, such as [1, 1, -1]"
_FACTOR = {"type": "number", "not": {"const": 0}}
_SCHEMA = {"anyOf": [_FACTOR, {"type": "array", "items": _FACTOR, "minItems": 3, "maxItems": 3}]}


def _scale(value: Any) -> Vector:
    factors = value if isinstance(value, list | tuple) else (value,) * 3
    if len(factors) != 3 or not all(is_number(factor) and factor for factor in factors):
        raise ConfigError(f"value {shown(value)}: expected {_SCALE}")
    x, y, z = map(float, factors)
    return x, y, z


class PartSettings(Strict):
    """A mesh in its place: scaled, then turned, then moved."""

    mesh: Text
    """A mesh file as `scene.mesh` names it."""
    move: Annotated[Vector, *three("[0, 0, 12.5]")] = (0.0, 0.0, 0.0)
    """How far along x, y and z."""
    turn: Annotated[Vector, *three("[90, 0, 0]")] = (0.0, 0.0, 0.0)
    """Degrees about x, then about y, then about z (Blender's XYZ), counter-clockwise seen from the
    end of the axis; [90, 0, 0] puts what is y up into z up."""
    scale: Annotated[Vector, parsed_by(_scale), Expect(_SCALE, _SCHEMA)] = (1.0, 1.0, 1.0)
    """Factor of its size, or one along each axis; what is mirrored keeps its outside."""

    @property
    def matrix(self) -> Floats:
        """The affine transformation, (4, 4) float64."""
        matrix = np.diag([*self.scale, 1.0])
        for axis, degrees in enumerate(self.turn):
            matrix = _turned(matrix, axis, degrees)
        matrix[:3, 3] = self.move
        return matrix


def _turned(matrix: Floats, axis: int, degrees: float) -> Floats:
    """The transformation followed by a turn; sums in a fixed order, which BLAS does not promise."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = _digits(math.cos, degrees), _digits(math.sin, degrees)
    turned = matrix.copy()
    turned[u] = cosine * matrix[u] - sine * matrix[v]
    turned[v] = sine * matrix[u] + cosine * matrix[v]
    return turned


def _digits(function: Any, degrees: float) -> float:
    """A sine or cosine to 12 places: libraries differ in the last one, and 90 degrees are exact."""
    return round(function(math.radians(math.fmod(degrees, 360.0))), 12)


Parts = Annotated[
    tuple[PartSettings, ...], *listed("a list such as [{mesh: car.glb, move: [0, 0, 2]}]", 1)
]
