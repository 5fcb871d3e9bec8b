"""Hits and itineraries against loops over all objects: 100,000 awkward rays for each scene."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.aimed_rays import aimed_rays
from oracles.brute_force import OPEN, BruteForce

from simmpp.scene.scene import Camera, Light, Material, MeshPart, Scene
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.frame import frame_of
from simmpp.workload.trace.geometry import Geometry, flatten
from simmpp.workload.trace.itineraries import SLACK, find_itineraries
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.workload import PRIMARY, SHADOW

RAYS = 100_000
TIE = 1e-9
"""Hits nearer to each other than this share of the scene's size may change places."""
LEAKS = 5e-5
"""Share of rays, all aimed at edges, that may pass at one. embree loses 150 times as many."""
SCENES = ("mountain:3", "rings:1", "tetra:4", "balls:2", "gears:1", "lattice:2", "tree:4")


def meshes() -> Scene:
    """Two overlapping wavy sheets of 128 triangles each: objects with trees of their own."""
    steps = np.linspace(0, 1, 9)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    corner = (np.arange(8)[:, None] * 9 + np.arange(8)).ravel()
    halves = [corner[:, None] + [0, 1, 10], corner[:, None] + [10, 9, 0]]
    faces = np.concatenate(halves).astype(np.int32)
    sheets = [
        MeshPart(np.stack([x, y, np.sin(5 * x + k) * np.cos(7 * y) / 5], axis=1), faces)
        for k in range(2)
    ]
    return Scene(
        "sheets", tuple(sheets), (Material(),), (Light((1, 2, 3)),), Camera((2, 2, 2), (0, 0, 0))
    )


def case(name: str) -> tuple[Scene, Geometry, BruteForce]:
    scene = meshes() if name == "meshes" else load_scene(name)
    frame = frame_of(scene)
    return scene, flatten(scene, frame), BruteForce(scene, frame.origin, frame.scale)


def search(geometry, origins, directions, limits=None):
    """Hits, distances, and itineraries as lists."""
    n = len(origins)
    kinds = np.full(n, PRIMARY if limits is None else SHADOW, dtype=np.uint8)
    limits = np.full(n, np.inf) if limits is None else limits
    claims = Intersector(geometry).claims(origins, directions)
    none = np.full(n, -1, dtype=np.int32)
    rays = RayBatch(origins, directions, kinds, limits, none, none, none)
    hits, distances, counts, objects = find_itineraries(geometry.shapes, rays, claims)
    return hits, distances, np.split(objects, np.cumsum(counts)[:-1])


@pytest.mark.parametrize("name", [*SCENES, "meshes"])
def test_nearest_hits(name: str) -> None:
    _, geometry, oracle = case(name)
    origins, directions = aimed_rays(geometry, RAYS, seed=1)
    hits, distances, _ = search(geometry, origins, directions)
    expected, expected_distances = oracle.nearest(origins, directions, geometry.shapes.t_min)
    assert (expected >= 0).mean() > 0.02
    wrong = ~_agree(hits, distances, expected, expected_distances)
    # A ray along a triangle and at its outline may pass: the tracer's tolerance is barycentric.
    o, d = origins[wrong], directions[wrong]
    without_edges = oracle.nearest(o, d, geometry.shapes.t_min, edge=OPEN)
    assert _agree(hits[wrong], distances[wrong], *without_edges).all()
    assert wrong.sum() <= RAYS * LEAKS


def _agree(hits, distances, expected, expected_distances):
    """The same object, or at the same distance; the same distance, or none."""
    with np.errstate(invalid="ignore"):
        near = np.abs(distances - expected_distances) < TIE
    return near | ((hits < 0) & (expected < 0))


def entries(geometry, origin, direction):
    """Where a ray enters each padded box, infinity if it doesn't: the slab test of textbooks."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        inverse = np.where(direction == 0, np.copysign(1e300, direction), 1 / direction)
        low, high = (geometry.boxes.reshape(-1, 2, 3) - origin).transpose(1, 0, 2) * inverse
    enter = np.maximum(np.minimum(low, high).max(axis=1), 0.0)
    return np.where(enter <= np.maximum(low, high).min(axis=1), enter, np.inf)


@pytest.mark.parametrize("name", [*SCENES, "meshes"])
def test_itineraries_are_all_boxes_up_to_the_hit(name: str) -> None:
    _, geometry, _ = case(name)
    origins, directions = aimed_rays(geometry, 2000, seed=2)
    directions[::10, 0] = 0.0
    directions[::10] /= np.linalg.norm(directions[::10], axis=1, keepdims=True)
    hits, distances, itineraries = search(geometry, origins, directions)
    for i, itinerary in enumerate(itineraries):
        enter = entries(geometry, origins[i], directions[i])
        entered = np.flatnonzero((enter <= distances[i] * SLACK) & np.isfinite(enter))
        assert itinerary.tolist() == sorted(entered, key=lambda k: (enter[k], k))
        assert hits[i] < 0 or hits[i] in itinerary


@pytest.mark.parametrize("name", [*SCENES, "meshes"])
def test_shadow_rays_end_at_their_first_blocker(name: str) -> None:
    _, geometry, _ = case(name)
    origins, directions = aimed_rays(geometry, 2000, seed=3)
    lights = np.random.default_rng(4).random(len(origins)) * 2
    hits, distances, itineraries = search(geometry, origins, directions, lights)
    # What one object alone does to a ray, the search of all has to add up to.
    for i, itinerary in enumerate(itineraries):
        enter = entries(geometry, origins[i], directions[i])
        order = sorted(np.flatnonzero(enter <= lights[i]), key=lambda k: (enter[k], k))
        end = order.index(hits[i]) + 1 if hits[i] >= 0 else len(order)
        assert itinerary.tolist() == order[:end]
        assert distances[i] < lights[i] if hits[i] >= 0 else distances[i] == np.inf


@pytest.mark.parametrize("name", ["mountain:2", "rings:1", "gears:1", "meshes"])
def test_shadow_rays_are_blocked_by_what_lies_before_the_light(name: str) -> None:
    _, geometry, oracle = case(name)
    origins, directions = aimed_rays(geometry, 20_000, seed=5)
    lights = np.random.default_rng(6).random(len(origins)) * 2
    hits, _, _ = search(geometry, origins, directions, lights)
    _, nearest = oracle.nearest(origins, directions, geometry.shapes.t_min)
    _, without_edges = oracle.nearest(origins, directions, geometry.shapes.t_min, edge=OPEN)
    clear = (np.abs(nearest - lights) > TIE) & ((nearest < lights) == (without_edges < lights))
    assert clear.mean() > 0.5
    assert ((hits >= 0) == (nearest < lights))[clear].all()
