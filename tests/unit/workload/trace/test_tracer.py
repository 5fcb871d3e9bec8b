"""What is traced: rays and their order, whoever proposes hits, wherever the scene lies."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from simmpp.common.errors import ConfigError, SceneError
from simmpp.scene.scene import Camera, Cone, Light, Material, Polygon, Scene, Sphere
from simmpp.workload import room
from simmpp.workload.check import check
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import REFLECTED, REFRACTED, SHADOW, Workload

FLOOR = [[-9.0, -9, -2], [9, -9, -2], [9, 9, -2], [-9, 9, -2]]
SMALL = Picture(resolution=24)
GLASS = Material(ks=0.1, transmittance=0.9, ior=1.5)
MIRROR = Material(ks=0.5)
DULL = Material()


LAMP = Light((0.0, -9.0, 9.0))


def scene(*objects, materials=(DULL,), lights=(LAMP,), eye=(0.0, -4.0, 0.0)):
    camera = Camera(eye=eye, at=(0.0, 0.0, 0.0))
    return Scene("made", tuple(objects), tuple(materials), tuple(lights), camera)


def arrays(workload: Workload) -> dict[str, bytes]:
    return {
        field.name: getattr(workload, field.name).tobytes()
        for field in dataclasses.fields(workload)
        if isinstance(getattr(workload, field.name), np.ndarray)
    }


class Silent(Intersector):
    def claims(self, origins, directions):
        return np.full((len(origins), 2), -1, dtype=np.int32)


class Moved(Intersector):
    """Every proposal belongs to the ray before."""

    def claims(self, origins, directions):
        return np.roll(super().claims(origins, directions), 1, axis=0)


class Liar(Intersector):
    """Proposes any object and any triangle that belongs to it, hit or not."""

    def __init__(self, geometry):
        super().__init__(geometry)
        self.rng = np.random.default_rng(0)

    def claims(self, origins, directions):
        return self._stands_for[self.rng.integers(len(self._stands_for), size=len(origins))]


class Forger(Intersector):
    """Proposes rows that belong to other objects, or are no triangles: bounds of no hit at all."""

    def __init__(self, geometry):
        super().__init__(geometry)
        self.rng = np.random.default_rng(0)
        self.limits = len(geometry.kinds), len(geometry.shapes.surfaces)

    def claims(self, origins, directions):
        return self.rng.integers(0, self.limits, (len(origins), 2)).astype(np.int32)


@pytest.mark.parametrize("witness", [Silent, Moved, Liar, Forger])
@pytest.mark.parametrize("name", ["mountain:3", "rings:1", "balls:2", "gears:1"])
def test_the_workload_is_the_same_whatever_embree_proposes(name, witness) -> None:
    honest = trace(load_scene(name), SMALL)
    assert arrays(trace(load_scene(name), SMALL, intersector=witness)) == arrays(honest)


def test_rays_are_numbered_generation_by_generation() -> None:
    glass = Sphere((0.0, 0.0, 0.0), 1.0, 1)
    floor = Polygon(np.array(FLOOR))
    lights = (Light((0.0, -9.0, 9.0)), Light((5.0, -5.0, 5.0)))
    workload = trace(scene(glass, floor, materials=(DULL, GLASS), lights=lights), SMALL)
    check(workload, "traced")
    middle = 12 * 24 + 12
    children = slice(*workload.child_offsets[middle : middle + 2])
    assert workload.hits[middle] == 0
    assert workload.kinds[children].tolist() == [REFLECTED, REFRACTED, SHADOW, SHADOW]
    assert set(workload.pixels[children]) == {middle}
    assert (np.diff(workload.parents[workload.n_primaries :]) >= 0).all()


@pytest.mark.parametrize("depth", [1, 2, 3])
def test_rays_end_at_the_greatest_depth(depth: int) -> None:
    workload = trace(load_scene("balls:2"), Picture(resolution=16, max_depth=depth))
    depths = np.ones(workload.n_rays, dtype=int)
    for ray in range(workload.n_primaries, workload.n_rays):
        depths[ray] = depths[workload.parents[ray]] + 1
    assert depths[workload.kinds != SHADOW].max() == depth
    assert depths[workload.kinds == SHADOW].max() == depth + 1


def test_no_rays_are_spawned_that_nobody_asked_for() -> None:
    glass = load_scene("mountain:2")
    everything = np.bincount(trace(glass, SMALL).kinds, minlength=4)
    assert everything.all()
    for setting, kind in (
        ("shadows", SHADOW),
        ("reflection", REFLECTED),
        ("refraction", REFRACTED),
    ):
        picture = dataclasses.replace(SMALL, **{setting: False})
        counts = np.bincount(trace(glass, picture).kinds, minlength=4)
        assert np.flatnonzero(counts == 0).tolist() == [kind]


def test_total_reflection_spawns_no_refracted_ray() -> None:
    inside = scene(Sphere((0.0, 0.0, 0.0), 1.0), materials=(GLASS,), eye=(0.0, -0.95, 0.0))
    workload = trace(inside, Picture(resolution=16, max_depth=2, shadows=False))
    counts = np.bincount(workload.kinds, minlength=4)
    # Snell: from 0.95 of the radius, sin(at the surface) <= 0.95 sin(at the eye) = 2/3 at 44.6 deg
    assert counts[REFLECTED] == 256 and 0 < counts[REFRACTED] <= 256
    wide = dataclasses.replace(
        inside, camera=Camera((0.0, -0.95, 0.0), (0.0, 0.0, 0.0), angle_degrees=120)
    )
    wider = np.bincount(
        trace(wide, Picture(resolution=16, max_depth=2, shadows=False)).kinds, minlength=4
    )
    assert wider[REFRACTED] < wider[REFLECTED] == 256


@pytest.mark.parametrize("material, shadows", [(GLASS, True), (DULL, False)])
def test_glass_is_lit_from_outside_and_what_is_opaque_on_the_side_that_is_seen(material, shadows):
    """An eye inside a sphere, a lamp outside: only light on the outside of glass arrives."""
    inside = scene(Sphere((0.0, 0.0, 0.0), 2.0), materials=(material,), eye=(0.0, -1.0, 0.0))
    lamp = dataclasses.replace(inside, lights=(Light((0.0, 90.0, 0.0)),))
    workload = trace(lamp, Picture(resolution=8, max_depth=1))
    of_shadows = workload.kinds == SHADOW
    assert of_shadows.sum() == (64 if shadows else 0)
    assert (workload.hits[of_shadows] == -1).all()


@pytest.mark.parametrize(
    "convex",
    [Sphere((0.0, 0.0, 0.0), 1.0), Cone((0.0, 0.0, -1.0), 1.0, (0.0, 0.0, 1.0), 0.5)],
    ids=["sphere", "cone"],
)
def test_what_is_convex_and_opaque_is_not_tested_by_rays_that_leave_it(convex) -> None:
    """The eye sees the outside of both; what the floor reflects may meet the cone's inside."""
    floor = Polygon(np.array(FLOOR))
    for material, left_out in ((MIRROR, True), (GLASS, False)):
        workload = trace(
            scene(convex, floor, materials=(material,)), Picture(resolution=8, max_depth=2)
        )
        assert 0 in workload.hits[: workload.n_primaries]
        for ray in range(workload.n_primaries, workload.child_offsets[workload.n_primaries]):
            source = workload.hits[workload.parents[ray]]
            tests = slice(*workload.itinerary_offsets[ray : ray + 2])
            assert (source in workload.itinerary_objects[tests]) != left_out


def test_an_empty_scene() -> None:
    workload = trace(scene(), SMALL)
    check(workload, "traced")
    assert workload.n_rays == workload.n_primaries == 576
    assert workload.n_tests == workload.n_objects == 0


def test_a_scene_that_is_never_hit() -> None:
    workload = trace(scene(Sphere((0.0, -9.0, 0.0), 1.0)), SMALL)
    assert workload.n_rays == 576 and (workload.hits == -1).all()


def test_an_eye_inside_a_sphere_sees_its_inside() -> None:
    workload = trace(scene(Sphere((0.0, 0.0, 0.0), 9.0)), SMALL)
    assert (workload.hits[:576] == 0).all()
    assert (workload.hit_distances[:576] > 12).all()


def test_a_light_inside_an_object_is_blocked_by_it_outside() -> None:
    lamp = Sphere((0.0, 0.0, 3.0), 1.0)
    floor = Polygon(np.array([[-9.0, -9, -1], [9, -9, -1], [9, 9, -1], [-9, 9, -1]]))
    workload = trace(scene(floor, lamp, lights=(Light((0.0, 0.0, 3.0)),)), SMALL)
    shadows = workload.kinds == SHADOW
    assert shadows.any() and (workload.hits[shadows] == 1).all()


def test_objects_without_a_surface_are_never_hit() -> None:
    point = (0.0, 0.0, 0.0)
    nothing = (
        Sphere(point, 0.0),
        Cone(point, 0.0, (0.0, 0.0, 1.0), 0.0),
        Cone(point, 1.0, point, 1.0),
        Polygon(np.array([[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]])),
    )
    workload = trace(scene(*nothing), Picture(resolution=25))
    assert (workload.hits == -1).all()
    assert workload.n_tests > 0


def moved(original: Scene, offset: tuple[float, float, float]) -> Scene:
    def at(point):
        return tuple(np.add(point, offset))

    objects = tuple(
        dataclasses.replace(item, vertices=item.vertices + offset) for item in original.objects
    )
    camera = original.camera
    camera = dataclasses.replace(camera, eye=at(camera.eye), at=at(camera.at))
    return dataclasses.replace(
        original,
        objects=objects,
        camera=camera,
        lights=tuple(Light(at(light.position)) for light in original.lights),
    )


def test_a_scene_moved_by_an_exact_offset_is_traced_to_the_same_bits() -> None:
    here = load_scene("tetra:4")  # its coordinates are dyadic
    camera = Camera(eye=(1.0, -3.125, -2.25), at=(0.0, 0.0, 0.25), up=(-1.0, -1.0, 1.0))
    here = dataclasses.replace(here, camera=camera)
    there = moved(here, (1024.0, -65536.0, 2.0**20))
    one, other = arrays(trace(here, SMALL)), arrays(trace(there, SMALL))
    assert one == other


def test_a_scene_of_another_unit_is_the_same_but_for_distances() -> None:
    here = load_scene("balls:2")
    big = 2.0**40
    objects = tuple(
        Sphere(tuple(np.multiply(item.centre, big)), item.radius * big, item.material)
        for item in here.objects
        if isinstance(item, Sphere)
    )
    small = dataclasses.replace(here, objects=here.objects[1:])
    camera = dataclasses.replace(here.camera, eye=tuple(np.multiply(here.camera.eye, big)))
    lights = tuple(Light(tuple(np.multiply(light.position, big))) for light in here.lights)
    large = dataclasses.replace(here, objects=objects, camera=camera, lights=lights)
    one, other = trace(small, SMALL), trace(large, SMALL)
    assert one.itinerary_objects.tobytes() == other.itinerary_objects.tobytes()
    assert (one.hit_distances * big).tobytes() == other.hit_distances.tobytes()


def test_progress_ends_when_all_rays_are_done() -> None:
    told: list[tuple[int, int]] = []
    workload = trace(
        load_scene("mountain:2"), SMALL, lambda done, known: told.append((done, known))
    )
    assert told[-1] == (workload.n_rays, workload.n_rays)
    assert all(done <= known for done, known in told)
    assert told == sorted(told)


def test_more_rays_than_numbers_are_refused(monkeypatch) -> None:
    n_rays = trace(load_scene("mountain:2"), SMALL).n_rays
    monkeypatch.setattr(room, "MOST_RAYS", n_rays)
    assert trace(load_scene("mountain:2"), SMALL).n_rays == n_rays
    for fewer in (n_rays - 1, 575):
        monkeypatch.setattr(room, "MOST_RAYS", fewer)
        with pytest.raises(ConfigError, match=f"mountain:2: .* more than {fewer} rays"):
            trace(load_scene("mountain:2"), SMALL)


@pytest.mark.parametrize(
    "bad, problem",
    [
        (scene(Sphere((0.0, np.nan, 0.0), 1.0)), "object 0 has a coordinate that is not finite"),
        (scene(eye=(0.0, 0.0, 0.0)), "looks from a point at itself"),
        (scene(eye=(0.0, 0.0, -5.0)), "parallel to the view"),
        (scene(Sphere((0.0, 0.0, 0.0), 1.0), materials=(Material(transmittance=1, ior=0),)), "ior"),
        (scene(Sphere((0.0, 0.0, 0.0), 1.0), lights=(Light((np.inf, 0.0, 0.0)),)), "light"),
    ],
)
def test_what_cannot_be_traced_is_refused(bad: Scene, problem: str) -> None:
    with pytest.raises(SceneError, match=problem):
        trace(bad, SMALL)


def digest_in_a_new_process(**environment: str) -> str:
    return subprocess.run(
        [sys.executable, __file__],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def test_hash_seeds_do_not_matter() -> None:
    seeds = [digest_in_a_new_process(PYTHONHASHSEED=seed) for seed in ("1", "2")]
    assert seeds[0] == seeds[1] == own_digest()


def test_processors_do_not_matter(tmp_path) -> None:
    """Compiled for the oldest processor of the family, without vector units or fused products."""
    plain = digest_in_a_new_process(NUMBA_CPU_NAME="generic", NUMBA_CACHE_DIR=str(tmp_path))
    assert plain == own_digest()


def own_digest() -> str:
    workload = trace(load_scene("mountain:4"), Picture(resolution=64))
    digest = hashlib.sha256()
    for name, data in sorted(arrays(workload).items()):
        digest.update(name.encode() + data)
    return digest.hexdigest()


if __name__ == "__main__":
    sys.stdout.write(own_digest())
