"""The tracer's own rays of a picture, primary and secondary, once more in Mitsuba 3.

Mitsuba computes in float32. In the normalised frame, where a scene has a size of at most 1, it
rounds coordinates by up to 6e-8; a ray that passes an edge or a silhouette nearer than that may go
either way. So a disagreement counts as an edge ray if the tracer itself, asked for rays that are
displaced by DISPLACED, gives Mitsuba's answer for one of them. Its Embree now and then loses a hit
where two triangles meet: a leak is a ray that hits, by the tracer, within DISPLACED of an edge.
Nothing else excuses a disagreement.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from importlib.resources import files

import numpy as np

from oracles.mitsuba_scene import MitsubaScene
from simmpp.scene.scene import Scene
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.itineraries import find_itineraries
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.trace.replay import recorded_generations, traced
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import POLYGON, SHADOW

SPD = ("balls:2", "gears:1", "mountain:4", "rings:1", "tetra:4", "lattice:2", "jacks:2")
MESHES = ("StanfordBunny.ply:2000", "planar_mesh.ply:500")
START = 1e-4
"""Rays are asked from that far along: float32 can't tell the surface they leave from the next."""
TOLERANCE = 1e-5
"""Of distances: 100 roundings of float32, as a grazing hit multiplies them."""
DISPLACED = 4e-6


def reflective(spec: str) -> Scene:
    """The scene with some material that reflects."""
    if ".ply" in spec:
        spec = str(files("pymeshfix") / "examples" / spec)
    scene = load_scene(spec)
    if any(material.reflects for material in scene.materials):
        return scene
    return replace(scene, materials=tuple(replace(m, ks=0.5) for m in scene.materials))


@dataclass(frozen=True)
class Comparison:
    """What came of the rays of one scene."""

    nearest: int
    """Rays whose nearest hit was compared."""
    hits: int
    """Those that hit, by the tracer."""
    shadows: int
    """Shadow rays compared: does anything lie before the light?"""
    too_near: int
    """Rays left out, whose recorded hit or light is nearer than START."""
    other_objects: int
    """Hits at the same distance, but of another object: at a shared edge, or coplanar."""
    edge_rays: int
    """Disagreements of rays beside an edge or a silhouette."""
    leaks: int
    """Rays that Mitsuba lets through where two triangles meet."""
    unexplained: int
    """All other disagreements."""
    largest_difference: float
    """Of distances that agree, normalised."""

    def __add__(self, other: Comparison) -> Comparison:
        largest = max(self.largest_difference, other.largest_difference)
        counts = [getattr(self, f.name) + getattr(other, f.name) for f in fields(self)[:-1]]
        return Comparison(*counts, largest)


def compare(scene: Scene, resolution: int, n_rays: int, seed: int = 0) -> Comparison:
    """Compare up to ``n_rays`` rays of each depth of the scene's picture."""
    picture = Picture(resolution=resolution)
    workload = trace(scene, picture)
    ours = traced(scene, picture, workload)
    theirs = MitsubaScene(scene, ours.frame)
    rng, total = np.random.default_rng(seed), Comparison(*[0] * 8, 0.0)
    for first, rays in recorded_generations(ours):
        chosen = rng.permutation(len(rays.kinds))[:n_rays]
        hits = workload.hits[first + chosen]
        distances = workload.hit_distances[first + chosen] * ours.frame.scale
        some = RayBatch._make(array[chosen] for array in rays)
        total += _compared(ours.geometry, theirs, some, hits, distances)
    return total


def _compared(
    geometry: Geometry,
    theirs: MitsubaScene,
    rays: RayBatch,
    hits: np.ndarray,
    distances: np.ndarray,
) -> Comparison:
    """``hits`` and ``distances`` are recorded for the rays from where they begin."""
    far = (distances > 2 * START) & (rays.limits > 2 * START)
    n_near, hits, distances = int((~far).sum()), hits[far], distances[far] - START
    rays = RayBatch._make(array[far] for array in rays)
    rays = rays._replace(origins=rays.origins + START * rays.directions, limits=rays.limits - START)
    shadow = rays.kinds == SHADOW
    answers = _answers(shadow, hits, distances)
    objects, found = np.full(len(hits), -1), np.empty(len(hits))
    some = (rays.origins[~shadow], rays.directions[~shadow])
    objects[~shadow], found[~shadow] = theirs.nearest(*some)
    found[shadow] = theirs.blocked(
        rays.origins[shadow], rays.directions[shadow], rays.limits[shadow]
    )
    same = _same(answers, found)
    both = same & ~shadow & (hits >= 0) & (objects >= 0)
    wrong = RayBatch._make(array[~same] for array in rays)
    beside = _of_a_ray_beside(geometry, wrong, found[~same])
    leaks = ~beside & _on_an_edge(geometry, wrong, distances[~same])
    n_edge, n_leaks = int(beside.sum()), int(leaks.sum())
    return Comparison(
        nearest=int((~shadow).sum()),
        hits=int((hits[~shadow] >= 0).sum()),
        shadows=int(shadow.sum()),
        too_near=n_near,
        other_objects=int((objects != hits)[both].sum()),
        edge_rays=n_edge,
        leaks=n_leaks,
        unexplained=int((~same).sum()) - n_edge - n_leaks,
        largest_difference=float(np.abs(answers[both] - found[both]).max(initial=0.0)),
    )


def _answers(shadow: np.ndarray, hits: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """The distance of the nearest hit, infinity for none; of a shadow ray 1 if blocked, else 0."""
    return np.where(shadow, hits >= 0, distances)


def _same(some: np.ndarray, others: np.ndarray) -> np.ndarray:
    with np.errstate(invalid="ignore"):
        return (some == others) | (np.abs(some - others) < TOLERANCE)


def _of_a_ray_beside(geometry: Geometry, rays: RayBatch, found: np.ndarray) -> np.ndarray:
    """Is the answer found that of the tracer for a ray displaced by DISPLACED? (n,) bool."""
    beside = np.zeros(len(found), bool)
    nothing = np.full(len(found), -1, np.int32)
    aside = np.cross(rays.directions, np.roll(rays.directions, 1, axis=1) + 0.1)
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    other = np.cross(rays.directions, aside)
    for turn in np.arange(8) * np.pi / 4:
        origins = rays.origins + DISPLACED * (np.cos(turn) * aside + np.sin(turn) * other)
        hits, distances, _, _ = find_itineraries(
            geometry.shapes,
            rays._replace(origins=origins, sources=nothing),
            np.stack([nothing, nothing], axis=1),
        )
        beside |= _same(_answers(rays.kinds == SHADOW, hits, distances), found)
    return beside


def _on_an_edge(geometry: Geometry, rays: RayBatch, distances: np.ndarray) -> np.ndarray:
    """Is the point at that distance within DISPLACED of a triangle's edge? (n,) bool."""
    corners, *edges = np.split(geometry.shapes.surfaces[_triangle_rows(geometry)], 3, axis=1)
    starts = [corners, corners, corners + edges[0]]
    ways = [edges[0], edges[1], edges[1] - edges[0]]
    near = np.zeros(len(distances), bool)
    for i in np.flatnonzero(np.isfinite(distances)):
        point = rays.origins[i] + distances[i] * rays.directions[i]
        for start, way in zip(starts, ways, strict=True):
            length = np.maximum((way**2).sum(axis=1), 1e-300)
            along = np.clip(((point - start) * way).sum(axis=1) / length, 0.0, 1.0)
            away = np.linalg.norm(start + along[:, None] * way - point, axis=1)
            near[i] |= bool((away < DISPLACED).any())
    return near


def _triangle_rows(geometry: Geometry) -> np.ndarray:
    return np.repeat(geometry.kinds >= POLYGON, np.maximum(geometry.n_triangles, 1))
