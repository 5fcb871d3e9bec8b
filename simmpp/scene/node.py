"""What every reader of meshes gives: a mesh in its place in the scene."""

from __future__ import annotations

from typing import NamedTuple

from simmpp.scene.cut import Indices
from simmpp.scene.scene import Floats, Material


class Node(NamedTuple):
    """A mesh in its place in the scene: what ``objects: nodes`` keeps whole."""

    name: str
    vertices: Floats
    """(n, 3) float64, in the scene's coordinates."""
    faces: Indices
    """(m, 3) int64 into ``vertices``, counter-clockwise seen from the outside."""
    material: Material
