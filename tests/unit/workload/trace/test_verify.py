"""Verification finds every test that was not made, made twice, or made up."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from simmpp.common.errors import WorkloadError
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.replay import traced
from simmpp.workload.trace.shading import render
from simmpp.workload.trace.tracer import trace
from simmpp.workload.trace.verify import hits_of_tests, verify
from simmpp.workload.workload import SHADOW

PICTURE = Picture(resolution=20)
SCENE = load_scene("mountain:3")
WORKLOAD = trace(SCENE, PICTURE)


def recorded_tests(workload):
    counts = np.diff(workload.itinerary_offsets)
    rays = np.repeat(np.arange(workload.n_rays, dtype=np.int32), counts)
    return rays, workload.itinerary_objects.copy()


@pytest.mark.parametrize("name", ["mountain:3", "rings:1", "gears:1", "balls:2", "tetra:3"])
@pytest.mark.parametrize("samples", ["centres", "corners"])
def test_the_itineraries_in_any_order_make_the_picture(name, samples) -> None:
    scene, picture = load_scene(name), Picture(resolution=20, samples=samples)
    workload = trace(scene, picture)
    rays, objects = recorded_tests(workload)
    order = np.random.default_rng(0).permutation(len(rays))
    assert verify(scene, picture, workload, rays[order], objects[order]) is None
    replayed = traced(scene, picture, workload)
    hits, distances = hits_of_tests(replayed, rays[order], objects[order])
    assert hits.tobytes() == workload.hits.tobytes()
    assert distances.tobytes() == workload.hit_distances.tobytes()


def test_a_test_that_was_not_made_shows_in_the_picture() -> None:
    rays, objects = recorded_tests(WORKLOAD)
    missing = np.flatnonzero((rays == 250) & (objects == WORKLOAD.hits[250]))
    found = verify(SCENE, PICTURE, WORKLOAD, np.delete(rays, missing), np.delete(objects, missing))
    assert WORKLOAD.hits[250] >= 0 and found is not None
    assert (found.row, found.column) == divmod(250, 20)
    assert found.expected == tuple(render(SCENE, PICTURE, WORKLOAD)[12, 10])
    assert found.expected != found.obtained
    assert "ray 250 is never tested" in str(found) and "pixel (12, 10)" in str(found)


@pytest.mark.parametrize("change", ["twice", "extra", "wrong object", "no such ray", "none"])
def test_other_tests_than_the_itineraries_are_differences(change) -> None:
    rays, objects = recorded_tests(WORKLOAD)
    if change == "twice":
        rays, objects = np.append(rays, rays[-1]), np.append(objects, objects[-1])
    elif change == "extra":
        rays, objects = np.append(rays, np.int32(0)), np.append(objects, np.int32(7))
    elif change == "wrong object":
        objects[0] += 1
    elif change == "no such ray":
        rays[-1] = WORKLOAD.n_rays
    else:
        rays, objects = rays[:0], objects[:0]
    assert verify(SCENE, PICTURE, WORKLOAD, rays, objects) is not None


def test_recorded_hits_that_were_tampered_with() -> None:
    shadow = np.flatnonzero((WORKLOAD.kinds == SHADOW) & (WORKLOAD.hits >= 0))[3]
    hits, distances = WORKLOAD.hits.copy(), WORKLOAD.hit_distances.copy()
    hits[shadow], distances[shadow] = -1, np.inf
    tampered = dataclasses.replace(WORKLOAD, hits=hits, hit_distances=distances)
    found = verify(SCENE, PICTURE, tampered, *recorded_tests(WORKLOAD))
    assert found is not None and f"ray {shadow}: its tests hit object" in found.reason


def test_a_distance_off_by_one_bit_is_a_difference() -> None:
    distances = WORKLOAD.hit_distances.copy()
    last = np.flatnonzero(WORKLOAD.hits >= 0)[-1]
    distances[last] = np.nextafter(distances[last], 0)
    tampered = dataclasses.replace(WORKLOAD, hit_distances=distances)
    assert verify(SCENE, PICTURE, tampered, *recorded_tests(WORKLOAD)) is not None


def test_hits_that_spawn_other_rays_are_a_difference() -> None:
    hits = WORKLOAD.hits.copy()
    parent = np.flatnonzero(np.diff(WORKLOAD.child_offsets))[0]
    hits[parent] = -1
    tampered = dataclasses.replace(WORKLOAD, hits=hits)
    found = verify(SCENE, PICTURE, tampered, *recorded_tests(WORKLOAD))
    assert found is not None and (found.row, found.column) == divmod(parent, 20)
    assert f"ray {parent} spawns other rays" in found.reason


def test_another_picture_is_refused() -> None:
    other = dataclasses.replace(PICTURE, max_depth=2)
    with pytest.raises(WorkloadError, match="another scene or picture"):
        verify(SCENE, other, WORKLOAD, *recorded_tests(WORKLOAD))
