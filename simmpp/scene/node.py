"""What every reader of meshes gives: meshes in their places, and the view that the file has."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from simmpp.scene.cut import Indices
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.scene import Camera, Floats, Light, Material, Vector


class Node(NamedTuple):
    """A mesh in its place in the scene: what ``objects: nodes`` keeps whole."""

    name: str
    vertices: Floats
    """(n, 3) float64, in the scene's coordinates."""
    faces: Indices
    """(m, 3) into ``vertices``, counter-clockwise seen from the outside."""
    material: Material


class Content(NamedTuple):
    """What a file holds."""

    nodes: Sequence[Node]
    cameras: tuple[tuple[str, Camera], ...] = ()
    """With their names."""
    lights: tuple[Light, ...] = ()
    suns: tuple[Light, ...] = ()
    """Lights so far away that only their direction counts: ``position`` is the way to them."""
    notes: tuple[str, ...] = ()
    """What the file says that was not read, one line each."""


def are_usable(vertices: Floats) -> bool:
    """Whether all numbers are finite and at most LARGEST."""
    low, high = vertices.min(initial=0.0), vertices.max(initial=0.0)  # NaN if one is
    return bool(low >= -LARGEST and high <= LARGEST)


def placed(vertices: Floats, faces: Indices, matrix: Floats) -> tuple[Floats, Indices]:
    """A mesh under an affine (4, 4) matrix; the faces of a mirrored one keep their outside."""
    linear = matrix[:3, :3]
    # As large as 1 along each axis, so that the sign of a tiny scene's determinant is not lost.
    sizes = np.abs(linear).max(axis=0)
    is_mirrored = np.linalg.det(linear / np.where(sizes > 0, sizes, 1.0)) < 0
    return transformed(vertices, matrix), faces[:, ::-1] if is_mirrored else faces


def transformed(points: Floats, matrix: Floats) -> Floats:
    """Points (n, 3) under an affine matrix: sums in a fixed order, which BLAS does not promise."""
    x, y, z = points.T
    return np.stack([m[0] * x + m[1] * y + m[2] * z + m[3] for m in matrix[:3]], axis=1)


def seen_through(camera: Camera, matrix: Floats) -> Camera:
    """The camera of what is put elsewhere; its angle stays as it is, whatever the size."""
    eye, at = transformed(np.array([camera.eye, camera.at]), matrix)
    return replace(camera, eye=as_vector(eye), at=as_vector(at), up=turned(camera.up, matrix))


def turned(direction: Vector, matrix: Floats) -> Vector:
    """A direction under an affine matrix, which does not move it."""
    ends = transformed(np.array([direction]), np.where(np.arange(4) < 3, matrix, 0.0))
    return as_vector(ends[0])


def as_vector(v: Floats) -> Vector:
    """Three numbers of an array (3,)."""
    return float(v[0]), float(v[1]), float(v[2])
