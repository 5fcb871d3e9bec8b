"""Vectors of three numbers in compiled code; every sum in the order x, y, z, so bits never move."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.scene.scene import Vector


@kernel
def vector(rows: NDArray[np.float64], i: int) -> Vector:
    """Row ``i`` of an array (n, 3) float64."""
    return rows[i, 0], rows[i, 1], rows[i, 2]


@kernel
def dot(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def minus(a: Vector, b: Vector) -> Vector:
    """From ``b`` to ``a``."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def times(factor: float, a: Vector) -> Vector:
    """The vector ``a``, scaled."""
    return factor * a[0], factor * a[1], factor * a[2]


@kernel
def moved(a: Vector, factor: float, b: Vector) -> Vector:
    """From ``a`` along ``b``, by ``factor`` of it."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@kernel
def normalised(a: Vector) -> Vector:
    """The vector at length 1."""
    # Three divisions, not one and three products: each component is then the nearest float64.
    length = math.sqrt(dot(a, a))
    return a[0] / length, a[1] / length, a[2] / length


@kernel
def basis_across(n: Vector) -> tuple[Vector, Vector]:
    """Two vectors across ``n`` (Duff et al. 2017, "Building an orthonormal basis, revisited")."""
    sign = math.copysign(1.0, n[2])
    a = -1.0 / (sign + n[2])
    b = n[0] * n[1] * a
    across = 1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]
    return across, (b, sign + n[1] * n[1] * a, -n[1])
