"""Hits and distances against Mitsuba 3, which shares no code with the tracer.

The rays are those of a picture: primary, reflected, refracted (Snell, inside the mountain's glass)
and shadow rays, up to SIMMPP_MITSUBA_RAYS (1,000 if unset) of each depth, drawn with a seed.
Surfaces are made reflective where the scene has none that are. Mitsuba has spheres, cylinders and
triangles, but no truncated cones: of the SPD only the tree is left out. The two scanned meshes are
those of the package pymeshfix, holes and all.
"""

from __future__ import annotations

import os

import pytest
from oracles.mitsuba_hits import MESHES, SPD, Comparison, compare, reflective

pytest.importorskip("mitsuba", reason="there are wheels for x86-64 only")

RAYS = int(os.environ.get("SIMMPP_MITSUBA_RAYS", "1000"))
RESOLUTION = 64
EDGE_RAYS = 1e-4
"""Share of rays that may pass so near an edge that float32 decides otherwise; at least one may."""


@pytest.mark.parametrize("spec", [*SPD, *MESHES])
def test_hits_and_distances_are_mitsubas(spec: str) -> None:
    got: Comparison = compare(reflective(spec), RESOLUTION, RAYS)
    n_rays = got.nearest + got.shadows
    assert got.hits > 0.1 * got.nearest
    assert got.too_near < 0.02 * n_rays
    assert got.unexplained == 0
    assert got.edge_rays + got.leaks + got.other_objects <= max(1, EDGE_RAYS * n_rays)
