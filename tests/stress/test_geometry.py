"""Awkward geometry: every ray hits what loops over all objects say, or nothing, and none gets lost.

The oracle (tests/oracles/brute_force.py) has other equations; distances agree within 1e-9 of the
scene's size unless a test says otherwise.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from oracles.brute_force import OPEN, BruteForce

import simmpp
from simmpp.common.errors import SceneError
from simmpp.scene.nff import read_nff
from simmpp.scene.scene import Camera, Cone, Light, Material, MeshPart, Polygon, Scene, Sphere
from simmpp.workload.check import check
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.frame import frame_of
from simmpp.workload.trace.geometry import Geometry, flatten
from simmpp.workload.trace.itineraries import find_itineraries
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.trace.shading import render
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import PRIMARY, REFLECTED, SHADOW, Workload

NEAR = 1e-9
DULL, MIRROR = Material(), Material(ks=0.5)
GLASS = Material(ks=0.1, transmittance=0.9, ior=1.5)
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SIDES = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
HALVES = np.concatenate([SIDES[:, [0, 1, 2]], SIDES[:, [0, 2, 3]]]).astype(np.int32)
SMALL = simmpp.Picture(resolution=16, max_depth=3)


def scene(*objects, materials=(DULL,), lights=((3.0, -9.0, 9.0),), eye=(0.3, -4.0, 0.4)) -> Scene:
    lamps = tuple(map(Light, lights))
    return Scene("made", tuple(objects), tuple(materials), lamps, Camera(eye, (0.3, 0.2, 0.4)))


def quad(*corners: tuple[float, float, float], material: int = 0) -> Polygon:
    return Polygon(np.array(corners), None, material)


def cube(kind: str) -> tuple[Polygon | MeshPart, ...]:
    if kind == "one mesh":
        return (MeshPart(CUBE, HALVES),)
    if kind == "twelve meshes":
        return tuple(MeshPart(CUBE, face[None]) for face in HALVES)
    return tuple(Polygon(CUBE[side]) for side in SIDES)


def shot(made: Scene, origins, directions) -> tuple[np.ndarray, np.ndarray, Geometry, BruteForce]:
    """Hits and distances of rays in scene units, and who can check them."""
    frame = frame_of(made)
    geometry = flatten(made, frame)
    o, d = frame.points(np.array(origins, float)), np.array(directions, float)
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    n = len(o)
    none = np.full(n, -1, np.int32)
    rays = RayBatch(o, d, np.full(n, PRIMARY, np.uint8), np.full(n, np.inf), none, none, none)
    claims = Intersector(geometry).claims(o, d)
    hits, distances, _, _ = find_itineraries(geometry.shapes, rays, claims)
    return (
        hits,
        frame.scene_lengths(distances),
        geometry,
        BruteForce(made, frame.origin, frame.scale),
    )


def agrees(made: Scene, origins, directions) -> np.ndarray:
    """Hits, once they are found to be the oracle's: the same distances, or none."""
    hits, distances, geometry, oracle = shot(made, origins, directions)
    frame = frame_of(made)
    d = np.array(directions, float)
    rays = frame.points(np.array(origins, float)), d / np.linalg.norm(d, axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        near = np.zeros(len(hits), bool)
        for edge in (1e-12, OPEN):
            ids, expected = oracle.nearest(*rays, geometry.shapes.t_min, edge=edge)
            close = np.abs(distances - frame.scene_lengths(expected)) < NEAR / frame.scale
            near |= close | ((ids < 0) & (hits < 0))
    assert near.all(), np.flatnonzero(~near)[:9]
    return hits


# --- shared edges and vertices, faces along the ray ---


@pytest.mark.parametrize("kind", ["six polygons", "one mesh", "twelve meshes"])
def test_a_closed_box_has_no_leak(kind: str) -> None:
    """Rays from within at its corners, along its edges and diagonals, and along the axes."""
    rng = np.random.default_rng(0)
    ends = CUBE[rng.integers(8, size=(4000, 2))]
    along = rng.random((4000, 1))
    targets = np.where(
        rng.random((4000, 1)) < 0.3, ends[:, 0], ends[:, 0] * along + ends[:, 1] * (1 - along)
    )
    origins = np.where(rng.random((4000, 1)) < 0.5, 0.5, 0.05 + 0.9 * rng.random((4000, 3)))
    directions = targets - origins
    kept = np.abs(directions).max(axis=1) > 0
    hits = agrees(scene(*cube(kind)), origins[kept], directions[kept])
    assert (hits >= 0).all()
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    middle = np.array([[0.5, 0.5, 0.5], [0.25, 0.75, 0.5], [0.5, 0.5, 0.25]])
    hits = agrees(scene(*cube(kind)), np.repeat(middle, 6, axis=0), np.tile(axes, (3, 1)))
    assert (hits >= 0).all()


@pytest.mark.parametrize("kind", ["six polygons", "one mesh", "twelve meshes"])
def test_a_ray_in_the_plane_of_a_face_hits_the_faces_across_it(kind: str) -> None:
    """Along the lower side z = 0 of a box: the side itself, without thickness, is no obstacle."""
    made = scene(*cube(kind))
    origins = [(-1.0, 0.5, 0.0), (0.25, -1.0, 0.0), (-1.0, -1.0, 0.0), (0.5, 0.5, -1.0)]
    directions = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    hits, distances, _, _ = shot(made, origins, directions)
    assert (hits >= 0).all()
    np.testing.assert_allclose(distances, [1, 1, np.sqrt(2), 1], atol=1e-14)


def test_a_ray_along_an_edge_ends_where_the_edge_does_or_passes() -> None:
    made = scene(quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)))
    hits, _, _, _ = shot(made, [(-1.0, 0.0, 0.0), (-1.0, 0.5, 0.0)], [(1.0, 0.0, 0.0)] * 2)
    assert hits.tolist() == [-1, -1]


# --- grazing ---


@pytest.mark.parametrize("size", [1e-3, 1.0])
def test_rays_that_graze_a_sphere(size: float) -> None:
    """Beyond 1e-12 of the radius geometry decides; at the radius itself it may touch."""
    made = scene(Sphere((0.0, 0.0, 0.0), size), Sphere((5.0, 0.0, 0.0), 1.0))
    past = np.array([-1e-3, -1e-6, -1e-9, -1e-12, 1e-12, 1e-9, 1e-6, 1e-3])
    origins = [(0.0, -1.0 - size, size * (1 + each)) for each in past]
    hits, distances, _, _ = shot(made, origins, [(0.0, 1.0, 0.0)] * len(past))
    assert (hits == np.where(past < 0, 0, -1)).all()
    expected = 1.0 + size - np.sqrt(-past[:4] * (2 + past[:4])) * size
    np.testing.assert_allclose(distances[:4], expected, atol=1e-6 * size)
    exactly, touched, _, _ = shot(made, [(0.0, -1.0 - size, size)], [(0.0, 1.0, 0.0)])
    assert exactly[0] in (-1, 0) and touched[0] in (np.inf, 1.0 + size)


# --- starting on surfaces ---


def test_what_leaves_a_surface_does_not_meet_it() -> None:
    """A mirror box seen from within: each reflection reaches another side than it left."""
    made = scene(
        *cube("six polygons"), materials=(MIRROR,), lights=((0.5, 0.5, 0.9),), eye=(0.3, 0.1, 0.4)
    )
    workload = trace(made, simmpp.Picture(resolution=24, max_depth=6))
    reflected = np.flatnonzero(workload.kinds == REFLECTED)
    assert len(reflected) == 5 * 576
    assert (workload.hits[reflected] >= 0).all()
    assert (workload.hits[reflected] != workload.hits[workload.parents[reflected]]).all()
    # The box is convex, so nothing stands between a side and the lamp.
    assert (workload.hits[workload.kinds == SHADOW] == -1).all()


def test_an_eye_on_a_surface_sees_past_it() -> None:
    floor = quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))
    made = dataclasses.replace(
        scene(floor, Sphere((0.0, 0.0, 2.0), 1.0)), camera=Camera((0, 0, 0), (0, 0, 2), (0, 1, 0))
    )
    workload = trace(made, SMALL)
    assert (workload.hits[: workload.n_primaries] == 1).any()
    assert not (workload.hits[: workload.n_primaries] == 0).any()


# --- degenerate, duplicate, coplanar, inside out ---


def mesh_scene(vertices: np.ndarray, faces: np.ndarray) -> Scene:
    floor = quad((-3, -3, -1), (3, -3, -1), (3, 3, -1), (-3, 3, -1))
    return scene(MeshPart(vertices, faces), floor)


def bumps() -> tuple[np.ndarray, np.ndarray]:
    """A closed ball of 320 triangles: a tree of its own."""
    from trimesh.creation import icosphere

    ball = icosphere(2, 0.8)
    return np.array(ball.vertices), np.array(ball.faces, np.int32)


def test_triangles_without_area_change_nothing() -> None:
    """Points, needles and repeated corners in a mesh: no hit, no NaN, the same picture."""
    vertices, faces = bumps()
    more = np.concatenate([vertices, [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.3, 0.3, 0.3]]])
    n = len(vertices)
    none = np.array([[0, 0, 0], [5, 5, 9], [7, 3, 7], [n, n + 1, n + 2], [n, n, n + 2]], np.int32)
    clean, dirty = (
        mesh_scene(vertices, faces),
        mesh_scene(more, np.concatenate([none, faces, none])),
    )
    one, other = trace(clean, SMALL), trace(dirty, SMALL)
    assert np.array_equal(one.hits, other.hits)
    assert np.array_equal(one.hit_distances, other.hit_distances)
    assert np.array_equal(render(clean, SMALL, one), render(dirty, SMALL, other))


def test_twice_the_same_triangles_change_nothing() -> None:
    vertices, faces = bumps()
    once, twice = mesh_scene(vertices, faces), mesh_scene(vertices, np.concatenate([faces, faces]))
    one, other = trace(once, SMALL), trace(twice, SMALL)
    for name in ("hits", "hit_distances", "itinerary_objects", "kinds"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()


def test_the_first_of_equal_objects_is_hit_and_both_are_tested() -> None:
    vertices, faces = bumps()
    balls = (MeshPart(vertices, faces), MeshPart(vertices, faces))
    spheres = (Sphere((0.0, 0.0, 0.0), 0.8), Sphere((0.0, 0.0, 0.0), 0.8))
    for twins in (balls, spheres):
        workload = trace(scene(*twins), SMALL)
        primaries = workload.hits[: workload.n_primaries]
        assert set(primaries.tolist()) == {-1, 0}
        for ray in np.flatnonzero(primaries == 0):
            tests = slice(*workload.itinerary_offsets[ray : ray + 2])
            assert workload.itinerary_objects[tests].tolist() == [0, 1]


def test_coplanar_polygons_are_hit_once_and_shade_nothing() -> None:
    """Overlapping sheets in a plane: the hit is one of them, and neither shades the other."""
    sheets = (
        quad((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)),
        quad((-0.7, -0.9, 0), (1.1, -0.8, 0), (0.6, 1.3, 0), (-0.9, 0.7, 0)),
    )
    made = scene(*sheets, lights=((1.0, -2.0, 5.0),), eye=(0.1, -2.0, 3.0))
    workload = trace(made, simmpp.Picture(resolution=40))
    check(workload, "traced")
    assert (workload.hits[workload.kinds == SHADOW] == -1).all()
    far = np.random.default_rng(1).normal(size=(2000, 3))
    far[:, 2] += 4
    agrees(made, far, np.random.default_rng(2).random((2000, 3)) * 2 - (1, 1, 0) - far)


def test_inside_out_is_the_same_if_opaque() -> None:
    vertices, faces = bumps()
    one, other = (trace(mesh_scene(vertices, f), SMALL) for f in (faces, faces[:, ::-1].copy()))
    for name in ("hits", "itinerary_objects", "kinds", "parents"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
    hit = one.hits >= 0
    np.testing.assert_allclose(one.hit_distances[hit], other.hit_distances[hit], rtol=1e-13)


# --- extremes of shape ---


@pytest.mark.parametrize("thin", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("tip", [0.0, 1.0])
def test_thin_cones(thin: float, tip: float) -> None:
    """A needle of length 1 from the side and along its axis; rays pass within its radius or not."""
    made = scene(
        Cone((0.1, 0.2, 0.3), thin, (0.1, 0.2, 1.3), thin * tip), Sphere((0.5, 3.0, 0.5), 0.5)
    )
    rng = np.random.default_rng(3)
    height, across = 0.3 + 0.9 * rng.random(500), rng.uniform(-2, 2, 500)
    width = thin * (1 - (height - 0.3) * (1 - tip))
    origins = np.stack([0.1 + width * across, np.full(500, -1.0), height], axis=1)
    hits, distances, _, _ = shot(made, origins, np.tile((0.0, 1.0, 0.0), (500, 1)))
    clear = np.abs(np.abs(across) - 1) > max(1e-6, 1e-15 / thin)  # where 0.1 has digits to tell
    assert clear.mean() > 0.9
    assert (hits == np.where(np.abs(across) < 1, 0, hits))[clear].all()
    assert not (hits == 0)[clear & (np.abs(across) > 1)].any()
    deep = 1.2 - np.sqrt(np.maximum(width**2 - (origins[:, 0] - 0.1) ** 2, 0))
    np.testing.assert_allclose(distances[hits == 0], deep[hits == 0], atol=2e-8)


def test_flat_cones_are_rings() -> None:
    """A cone of height 1e-9 from above: hit between its radii, free in the hole."""
    made = scene(Cone((0, 0, 0), 1.0, (0, 0, 1e-9), 0.5), Sphere((0.0, 0.0, -5.0), 0.2))
    x = np.linspace(0.01, 1.3, 130)
    hits, distances, _, _ = shot(made, [(each, 0.0, 2.0) for each in x], [(0.0, 0.0, -1.0)] * 130)
    clear = np.minimum(np.abs(x - 0.5), np.abs(x - 1.0)) > 1e-6
    assert ((hits == 0) == ((x > 0.5) & (x < 1.0)))[clear].all()
    np.testing.assert_allclose(distances[hits == 0], 2.0, atol=1e-6)


def test_what_has_no_surface_in_a_file_is_refused() -> None:
    view = "v from 0 -4 0 at 0 0 0 up 0 0 1 angle 45\n"
    for line, problem in (
        ("s 0 0 0 0", "radius other than 0"),
        ("s 0 0 0 -0.0", "radius other than 0"),
        ("s 0 0 0 1e-400", "radius other than 0"),
        ("c 0 0 0 0 0 0 1 0", "radius other than 0"),
        ("c 0 0 0 1 0 0 0 1", "the same point"),
        ("s nan 0 0 1", "finite number"),
        ("s 0 0 0 inf", "finite number"),
        ("p 3 0 0 0 1 0 0 0 1e999 0", "finite number"),
        ("l 0 -inf 0", "finite number"),
        ("f nan 1 1 1 0 0 0 0", "finite number"),
        ("b 1 1 -1", "must not be negative"),
        ("pp 3" + " 0 0 0 0 0 0" * 3, "no length"),
    ):
        with pytest.raises(SceneError, match=problem) as refused:
            read_nff(view + line, name="a", where="a.nff")
        assert str(refused.value).startswith("a.nff:2: ")


def test_subnormal_coordinates_are_zeros() -> None:
    """5e-324 beside 1 makes no difference; a scene of that size is refused."""
    for tiny in (5e-324, 1e-310):
        exact = scene(Sphere((0.0, 0.0, 0.0), 1.0), quad((0, 0, -2), (1, 0, -2), (0, 1, -2)))
        near = scene(Sphere((tiny, 0.0, -tiny), 1.0), quad((0, tiny, -2), (1, 0, -2), (0, 1, -2)))
        one, other = trace(exact, SMALL), trace(near, SMALL)
        assert one.hits.tobytes() == other.hits.tobytes()
        with pytest.raises(SceneError, match="extent is"):
            trace(scene(Sphere((0.0, 0.0, 0.0), tiny)), SMALL)


# --- eyes, lamps and pictures ---


def whole(workload: Workload) -> Workload:
    check(workload, "traced")
    return workload


def test_lamps_at_surfaces() -> None:
    """A lamp in the plane of a polygon, on a sphere, at the very point hit, and just above."""
    floor = quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    eye = Camera((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    for lamp in (
        (0.0, 0.0, 0.0),
        (0.5, 0.5, 0.0),
        (0.0, 0.0, 1e-200),
        (0.0, 0.0, 1e-20),
        (2.0, 0.0, 0.0),
    ):
        made = dataclasses.replace(scene(floor, lights=(lamp,)), camera=eye)
        workload = whole(trace(made, simmpp.Picture(resolution=3)))
        assert (workload.hits[workload.kinds == SHADOW] == -1).all()
        with np.errstate(all="raise"):
            render(made, simmpp.Picture(resolution=3), workload)
    ball = scene(Sphere((0.0, 0.0, 0.0), 1.0), lights=((0.0, -1.0, 0.0),))
    workload = whole(trace(ball, SMALL))
    assert (workload.hits[workload.kinds == SHADOW] == -1).all()


@pytest.mark.parametrize("material", [DULL, MIRROR, GLASS])
@pytest.mark.parametrize("kind", ["one mesh", "six polygons"])
def test_an_eye_inside_a_box_sees_it_everywhere(kind: str, material: Material) -> None:
    made = scene(*cube(kind), materials=(material,), eye=(0.31, 0.22, 0.41))
    workload = whole(trace(made, SMALL))
    assert (workload.hits[: workload.n_primaries] >= 0).all()


def test_pictures_of_one_pixel_of_one_object() -> None:
    for samples, n in (("centres", 1), ("corners", 4)):
        picture = simmpp.Picture(resolution=1, samples=samples)
        workload = whole(trace(scene(Sphere((0.3, 0.2, 0.4), 2.0)), picture))
        assert workload.n_primaries == n and workload.n_objects == 1
        assert render(scene(Sphere((0.3, 0.2, 0.4), 2.0)), picture, workload).shape == (1, 1, 3)


def test_angles_of_view_from_nothing_to_a_half_space() -> None:
    for angle in (1e-300, 1e-9, 179.999999):
        made = scene(*cube("six polygons"))
        camera = dataclasses.replace(made.camera, angle_degrees=angle)
        whole(trace(dataclasses.replace(made, camera=camera), SMALL))
    for angle in (0.0, 180.0, np.nan, np.inf, -1.0):
        camera = dataclasses.replace(made.camera, angle_degrees=angle)
        with pytest.raises(SceneError, match="angle"):
            trace(dataclasses.replace(made, camera=camera), SMALL)
