"""Rotation, scaling and translation of points, in the SPD library's conventions.

Points are rows, multiplied from the left (v' = v M) with a 4x4 matrix; translation is in row 4.
The order of every sum is the SPD's: it fixes values of about 1e-16 that should be zero, which
its files print. Plain floats, because numpy does not promise an order.
"""

from __future__ import annotations

import math

from simmpp.scene.scene import Vector

MatrixRow = tuple[float, float, float, float]
Matrix = tuple[MatrixRow, MatrixRow, MatrixRow, MatrixRow]

IDENTITY: Matrix = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))


def rotation_x(angle: float) -> Matrix:
    """Rotate by ``angle`` radians about X, Y towards Z."""
    c, s = math.cos(angle), math.sin(angle)
    return ((1, 0, 0, 0), (0, c, s, 0), (0, -s, c, 0), (0, 0, 0, 1))


def rotation_y(angle: float) -> Matrix:
    """Rotate by ``angle`` radians about Y, Z towards X."""
    c, s = math.cos(angle), math.sin(angle)
    return ((c, 0, -s, 0), (0, 1, 0, 0), (s, 0, c, 0), (0, 0, 0, 1))


def rotation_z(angle: float) -> Matrix:
    """Rotate by ``angle`` radians about Z, X towards Y."""
    c, s = math.cos(angle), math.sin(angle)
    return ((c, s, 0, 0), (-s, c, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))


def rotation_about(axis: Vector, angle: float) -> Matrix:
    """Rotate by ``angle`` radians about the unit vector ``axis``, counter-clockwise."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    k = 1 - c
    return (
        (x * x + (1 - x * x) * c, x * y * k + z * s, x * z * k - y * s, 0),
        (x * y * k - z * s, y * y + (1 - y * y) * c, y * z * k + x * s, 0),
        (x * z * k + y * s, y * z * k - x * s, z * z + (1 - z * z) * c, 0),
        (0, 0, 0, 1),
    )


def scaling(factor: float) -> Matrix:
    """Scale about the origin."""
    return ((factor, 0, 0, 0), (0, factor, 0, 0), (0, 0, factor, 0), (0, 0, 0, 1))


def translation(x: float, y: float, z: float) -> Matrix:
    """Move by (x, y, z)."""
    return ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (x, y, z, 1))


def product(a: Matrix, b: Matrix) -> Matrix:
    """``a`` first, then ``b``."""

    def row(i: int) -> MatrixRow:
        p, q, r, t = a[i]
        x, y, z, w = (p * b[0][j] + q * b[1][j] + r * b[2][j] + t * b[3][j] for j in range(4))
        return x, y, z, w

    return row(0), row(1), row(2), row(3)


def transform(v: Vector, m: Matrix) -> Vector:
    """The point ``v`` under ``m``."""
    x, y, z = v
    return (
        x * m[0][0] + y * m[1][0] + z * m[2][0] + m[3][0],
        x * m[0][1] + y * m[1][1] + z * m[2][1] + m[3][1],
        x * m[0][2] + y * m[1][2] + z * m[2][2] + m[3][2],
    )
