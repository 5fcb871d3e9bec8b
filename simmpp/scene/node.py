"""What every reader of meshes gives: a mesh in its place in the scene."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from simmpp.scene.cut import Indices
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.scene import Floats, Material


class Node(NamedTuple):
    """A mesh in its place in the scene: what ``objects: nodes`` keeps whole."""

    name: str
    vertices: Floats
    """(n, 3) float64, in the scene's coordinates."""
    faces: Indices
    """(m, 3) into ``vertices``, counter-clockwise seen from the outside."""
    material: Material


def are_usable(vertices: Floats) -> bool:
    """Whether all numbers are finite and at most LARGEST."""
    low, high = vertices.min(initial=0.0), vertices.max(initial=0.0)  # NaN if one is
    return bool(low >= -LARGEST and high <= LARGEST)


def placed(vertices: Floats, faces: Indices, matrix: Floats) -> tuple[Floats, Indices]:
    """A mesh under an affine (4, 4) matrix; the faces of a mirrored one keep their outside.

    Sums are in a fixed order, which BLAS does not promise.
    """
    x, y, z = vertices.T
    rows = [m[0] * x + m[1] * y + m[2] * z + m[3] for m in matrix[:3]]
    is_mirrored = np.linalg.det(matrix[:3, :3]) < 0
    return np.stack(rows, axis=1), faces[:, ::-1] if is_mirrored else faces
