"""Rays of the SPD's default scenes against the two published tables.

Haines' README (1987) and Havran's statistics, both distributed with the SPD: 513 x 513 corner
samples, depth 5. Haines' camera spanned 512/511 of the angle, which costs his counts 0.3 %.
"""

from __future__ import annotations

import numpy as np
import pytest

from simmpp.scene.load import load_scene
from simmpp.workload.picture import Picture
from simmpp.workload.tracer import trace
from simmpp.workload.workload import PRIMARY, REFLECTED, REFRACTED, SHADOW

PRIMARY_HITS = {"mountain:6": 173685, "rings:7": 263169, "tetra:6": 49950}
"""Havran's; the camera is his."""
SHADOW_RAYS = {
    "mountain:6": (361037, 412922),
    "rings:7": (1077336, 1085002),
    "tetra:6": (46112, 46262),
}
SECONDARY_RAYS = {
    "mountain:6": (2 * 354769, 710436),
    "rings:7": (312879, 315236),
    "tetra:6": (0, 0),
}


@pytest.mark.parametrize("name", PRIMARY_HITS)
def test_counts_lie_within_the_published_ones(name: str) -> None:
    workload = trace(load_scene(name), Picture(samples="corners"))
    counts = np.bincount(workload.kinds, minlength=4)
    assert counts[PRIMARY] == 513 * 513
    primary_hits = np.count_nonzero(workload.hits[: counts[PRIMARY]] >= 0)
    assert abs(primary_hits - PRIMARY_HITS[name]) <= 2
    for count, (low, high) in (
        (counts[SHADOW], SHADOW_RAYS[name]),
        (counts[REFLECTED] + counts[REFRACTED], SECONDARY_RAYS[name]),
    ):
        assert 0.97 * low <= count <= 1.03 * high
