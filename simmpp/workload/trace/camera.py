"""Primary rays: one through each sample of the picture, row by row."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import SceneError
from simmpp.scene.scene import Camera
from simmpp.workload.picture import Picture
from simmpp.workload.trace.frame import Frame

Floats = NDArray[np.float64]

FAR = 1e100
"""Distance in scene sizes beyond which squares might overflow."""


def primary_rays(camera: Camera, picture: Picture, frame: Frame) -> tuple[Floats, Floats]:
    """Origin (3,) and directions (rows * columns, 3) float64 of length 1, normalised.

    The upper and lower edge of the picture lie at +-tan(angle / 2), the others as far away as
    makes pixels squares; the first row is the top one.
    """
    forward, right, up = basis(camera, frame)
    reach = tangent(camera.angle_degrees)
    rows, columns = picture.pixels
    across = (reach * _steps(columns, rows, picture))[None, :, None] * right
    down = (reach * -_steps(rows, rows, picture))[:, None, None] * up
    directions = (forward + down + across).reshape(-1, 3)
    return frame.points(np.array(camera.eye)), _unit(directions)


def _steps(n: int, rows: int, picture: Picture) -> Floats:
    """Places of the samples along a side of ``n`` pixels; half the picture's height is 1."""
    if picture.samples == "corners":
        return (2.0 * np.arange(n + 1) - n) / rows
    return (2.0 * np.arange(n) + 1.0 - n) / rows


def basis(camera: Camera, frame: Frame) -> tuple[Floats, Floats, Floats]:
    """Forward, right and up, of length 1; SceneError for a camera that sees nothing."""
    eye, at = frame.points(np.array([camera.eye, camera.at]))
    up = np.array(camera.up, dtype=np.float64)
    if not (np.abs([eye, at, up]) < FAR).all():
        raise SceneError(f"the camera is not finite, or too far away: {camera}")
    if (eye == at).all():
        raise SceneError(f"the camera looks from a point at itself: {camera.eye}")
    forward = _unit(at - eye)
    right = np.cross(forward, up)
    if not _lengths(right)[0] > 1e-12 * _lengths(up)[0]:
        raise SceneError(f"the camera's up {camera.up} is parallel to the view, or zero")
    right = _unit(right)
    return forward, right, np.cross(right, forward)


def _unit(vectors: Floats) -> Floats:
    return vectors / _lengths(vectors)


def _lengths(vectors: Floats) -> Floats:
    """Lengths (..., 1); products and sums only, so that every CPU gives the same bits."""
    x, y, z = vectors[..., 0:1], vectors[..., 1:2], vectors[..., 2:3]
    lengths: Floats = np.sqrt(x * x + y * y + z * z)
    return lengths


def tangent(angle_degrees: float) -> float:
    """tan(angle / 2) to 12 digits: libraries differ in the last one."""
    if not 0.0 < angle_degrees < 180.0:
        raise SceneError(f"the camera's angle is {angle_degrees}, expected 0 < degrees < 180")
    return float(f"{math.tan(math.radians(angle_degrees) / 2):.12g}")
