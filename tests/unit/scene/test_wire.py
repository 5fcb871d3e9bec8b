"""Sizes on the wire, worked out by hand."""

import numpy as np
import pytest

from simmpp.scene.scene import Cone, MeshPart, Polygon, SceneObject, Sphere
from simmpp.scene.wire import bytes_on_the_wire

POINTS = np.zeros((6, 3))
FACES = np.zeros((4, 3), dtype=np.int32)


@pytest.mark.parametrize(
    ("item", "expected"),
    [
        (Sphere((0, 0, 0), 1), 128),
        (Cone((0, 0, 0), 1, (0, 0, 1), 1), 128),
        (Polygon(POINTS[:3]), 128),
        (Polygon(POINTS), 128 + 3 * 24),
        (Polygon(POINTS[:3], POINTS[:3]), 128 + 3 * 24),
        (MeshPart(POINTS, FACES), 56 + 6 * 24 + 4 * 12),
        (MeshPart(POINTS[:3], FACES[:1]), 128 + 12),
    ],
)
def test_bytes(item: SceneObject, expected: int) -> None:
    assert bytes_on_the_wire(item) == expected
