"""Rays of patches as a workload: the same whoever traces them, made again from tests."""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from path_scenes import quad, walls

from simmpp.common.compiled import njit
from simmpp.common.errors import ConfigError, SceneError
from simmpp.scene.scene import Camera, Material, Polygon, Scene
from simmpp.workload.check import check
from simmpp.workload.picture import Picture
from simmpp.workload.radiosity.points import disc, mirrored
from simmpp.workload.radiosity.room import Room, room_of
from simmpp.workload.radiosity.settings import Radiosity
from simmpp.workload.radiosity.source import RadiositySource
from simmpp.workload.radiosity.tracing import again, trace_patches
from simmpp.workload.trace import tracer
from simmpp.workload.workload import ARRAYS, FORM_FACTOR, Workload

Floats = NDArray[np.float64]
GREY, LAMP = Material((0.6, 0.6, 0.6)), Material((0.3, 0.3, 0.3), emission=(3.0, 2.0, 1.0))
CAMERA = Camera((5.0, 0.3, 5.0), (5.0, 10.0, 4.5), angle_degrees=80.0)
LAMP_FACE = quad((3, 3, 9.5), (3, 7, 9.5), (7, 7, 9.5), (7, 3, 9.5), material=1)
METHODS = ("gathering", "shooting")
SMALL = {"patches": "3%", "rays": 50, "resolution": 8}


def scene_of(grey: Material = GREY, lamp: Material = LAMP) -> Scene:
    objects = (*walls((0, 0, 0), (10, 10, 10), (0,) * 6), LAMP_FACE)
    return Scene("room", objects, (grey, lamp), (), CAMERA)


@cache
def case(method: str) -> tuple[RadiositySource, Room, Workload]:
    settings = Radiosity(method=method, **SMALL)  # type: ignore[arg-type]
    room = room_of(scene_of(), settings)
    return RadiositySource(scene_of, settings), room, trace_patches(room, threads=1)


def contents(workload: Workload) -> dict[str, bytes]:
    return {name: getattr(workload, name).tobytes() for name in ARRAYS}


@pytest.mark.parametrize("method", METHODS)
def test_a_workload_is_whole(method: str) -> None:
    _, room, workload = case(method)
    check(workload, "here")
    assert set(workload.kinds.tolist()) == {FORM_FACTOR}
    assert workload.n_rays == workload.n_primaries == len(workload.root_homes)
    assert workload.n_objects == room.n_sides // 2
    rows = np.repeat(np.arange(workload.n_rays), np.diff(workload.itinerary_offsets))
    # No ray is tested against the patch that it leaves.
    assert not (workload.itinerary_objects == workload.root_homes[rows]).any()


def test_only_sides_that_light_reaches_send_rays() -> None:
    _, room, workload = case("gathering")
    sent = np.bincount(workload.root_homes, minlength=workload.n_objects)
    lamp = room.patches.parts == 6
    counts = np.maximum(np.floor(50 * room.patches.areas / room.patches.areas.mean() + 0.5), 16)
    assert (sent[lamp] == 2 * counts[lamp]).all()  # both sides shine
    assert (sent[~lamp] == counts[~lamp]).all()  # nothing reaches the outside of the walls


def test_rounds_are_shots() -> None:
    _, _, workload = case("shooting")
    assert workload.picture == (workload.n_rounds, 50)
    assert workload.root_rounds.tolist() == np.repeat(range(workload.n_rounds), 50).tolist()
    residuals = workload.round_residuals
    assert len(residuals) == workload.n_rounds
    assert (np.diff(residuals) < 0).all()
    assert residuals[-1] <= 0.01 < residuals[-2]
    powers = workload.root_weights.reshape(-1, 50).sum(axis=1)
    assert (np.diff(powers[:4]) <= 0).all()  # the lamp's four sides
    assert powers.sum() > 2.0**17


@pytest.mark.parametrize("method", METHODS)
def test_it_is_the_same_on_any_number_of_threads(
    method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, room, workload = case(method)
    monkeypatch.setattr(tracer, "BATCH", 97)
    assert contents(trace_patches(room, threads=3)) == contents(workload)


@pytest.mark.parametrize("method", METHODS)
def test_tests_make_the_hits_again(method: str) -> None:
    source, _, workload = case(method)
    counts = np.diff(workload.itinerary_offsets)
    rays = np.repeat(np.arange(workload.n_rays, dtype=np.int32), counts)
    objects = workload.itinerary_objects.copy()
    assert source.verify(Picture(), workload, rays, objects) == ""
    problem = source.verify(Picture(), workload, rays[1:], objects[1:])
    assert problem == f"ray {rays[0]} is never tested against object {objects[0]}"


@pytest.mark.parametrize("method", METHODS)
def test_what_is_done_is_drawn(method: str) -> None:
    source, room, workload = case(method)
    whole, done = source.draw(Picture(), workload), np.ones(workload.n_rays, np.bool_)
    assert whole.shape == (8, 8, 3)
    assert (source.draw(Picture(), workload, done) == whole).all()
    # Of gathering the last wall does not count, of shooting all from a round on.
    done[-200:] = False
    part = again(room, workload, done)[0].brightness
    light = again(room, workload)[0].brightness
    assert (part <= light + 1e-9).all() if method == "shooting" else (part != light).any()
    assert not (part == light).all()


def test_results_have_a_row_for_each_patch() -> None:
    source, room, workload = case("gathering")
    table = source.results(workload)
    assert {len(column) for column in table.values()} == {workload.n_objects}
    lamp = table["part"] == 6
    assert (table["red"][lamp] > 3).all()
    assert (table["red"][~lamp] < 3).all()
    assert (table["back_red"][~lamp] > 0).any()  # some walls show their backs to the inside
    assert table["hits"].sum() == (workload.hits >= 0).sum()
    assert table["x"].min() == 0
    assert table["x"].max() == 10
    assert room.patches.areas.sum() == pytest.approx(600 + 16)


def test_the_digest_follows_what_decides() -> None:
    bright = dataclasses.replace(LAMP, emission=(6.0, 2.0, 1.0))

    def digest(method: str, lamp: Material = LAMP, **settings: object) -> str:
        asked = Radiosity(method=method, **{**SMALL, **settings})  # type: ignore[arg-type]
        return room_of(scene_of(lamp=lamp), asked).digest

    for method in METHODS:
        assert digest(method) == case(method)[2].digest == digest(method, resolution=9)
        changed = [digest(method, **{key: value})  # type: ignore[arg-type]
                   for key, value in (("rays", 51), ("patches", "2%"), ("seed", 1))]  # fmt: skip
        assert len({digest(method), *changed}) == 4
    assert digest("gathering", bright) == digest("gathering")
    assert digest("shooting", bright) != digest("shooting")


@pytest.mark.parametrize("method", METHODS)
def test_light_that_never_ends_is_refused(method: str) -> None:
    white = Material((1.0, 1.0, 1.0))
    settings = Radiosity(method=method, patches="20%", rays=50)  # type: ignore[arg-type]
    lamp = dataclasses.replace(LAMP, colour=(1.0, 0.0, 0.0))
    with pytest.raises(SceneError, match=r"room: light never ends: patches reflect all of it"):
        trace_patches(room_of(scene_of(white, lamp), settings), threads=1)
    above = quad((3, 3, 10), (3, 7, 10), (7, 7, 10), (7, 3, 10), material=1)
    grey = [Polygon(wall.vertices, None, 2) for wall in walls((0, 0, 0), (20, 20, 20), (0,) * 6)]  # type: ignore[union-attr]
    inner = scene_of(white, lamp)
    within = dataclasses.replace(
        inner, objects=(*inner.objects, above, *grey), materials=(*inner.materials, GREY)
    )
    with pytest.raises(SceneError, match=r"light never ends"):
        trace_patches(room_of(within, settings), threads=1)
    opened = dataclasses.replace(scene_of(white, lamp), objects=scene_of().objects[1:])
    trace_patches(room_of(opened, settings), threads=1)


def test_too_many_rays_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("simmpp.workload.room.MOST_RAYS", 1000)
    for method in METHODS:
        room = room_of(scene_of(), Radiosity(method=method, **SMALL))  # type: ignore[arg-type]
        with pytest.raises(ConfigError, match=r"more than 1000 rays"):
            trace_patches(room, threads=1)


@njit
def _discs(n: int, points: Floats) -> None:
    for k in range(n):
        points[k, 0], points[k, 1] = disc((k + 0.5) / n, mirrored(k, 2))


def test_points_lie_evenly_on_the_disc() -> None:
    n = 4096
    points = np.empty((n, 2))
    _discs(n, points)
    radii = (points**2).sum(axis=1)
    assert radii.max() <= 1 + 1e-15
    assert np.abs(np.sort(radii) - (np.arange(n) + 0.5) / n).max() < 0.01
    assert np.abs(points.mean(axis=0)).max() < 0.01


def test_a_patch_is_a_polygon_of_its_own() -> None:
    _, room, _ = case("gathering")
    assert all(isinstance(obj, Polygon) for obj in room.patches.scene.objects)
