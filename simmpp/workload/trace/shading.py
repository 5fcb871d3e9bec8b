"""The picture of a workload (Whitted 1980): one processor's answer, which all others must equal."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from simmpp.common.compiled import kernel, njit
from simmpp.common.files import replaced
from simmpp.scene.scene import Scene, Vector
from simmpp.workload.picture import CORNERS, PATH, Picture
from simmpp.workload.trace.exact import ray_of
from simmpp.workload.trace.geometry import Geometry
from simmpp.workload.trace.itineraries import Work, work_for
from simmpp.workload.trace.path.radiance import light_of_roots, picture_of_roots
from simmpp.workload.trace.ray_batch import RayBatch
from simmpp.workload.trace.replay import Traced, recorded_generations, traced
from simmpp.workload.trace.surface import Surface, faces, reflected, surface_at
from simmpp.workload.trace.vectors import dot, minus, normalised, vector
from simmpp.workload.workload import REFLECTED, SHADOW, Workload

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Flags = NDArray[np.bool_]

AMBIENT = 0.1
"""Light that comes from everywhere. ESTIMATE: NFF has none, the SPD asks for a little."""


class Lighting(NamedTuple):
    """What shading reads of a scene."""

    materials: Floats
    """(N, 7) float64 of each object: red, green, blue, kd, ks, shine, transmittance."""
    lights: Floats
    """(L, 3) float64, normalised."""
    colours: Floats
    """(L, 3) float64: of the lights, times sqrt(L) / (2 L) as the SPD suggests."""
    background: Floats
    """(3,) float64."""
    shadows: bool
    """Lights are seen by shadow rays; else by every surface that faces them."""


def render(
    scene: Scene, picture: Picture, workload: Workload, done: Flags | None = None
) -> NDArray[np.uint8]:
    """The picture of the recorded hits, (rows, columns, 3) uint8.

    ``done`` (n0,) bool are the primary rays that count, all by default; a pixel that has none, or
    one whose corners are not all there, is black.

    Raises
    ------
    WorkloadError
        The workload is not of this scene and picture.
    """
    return shade(traced(scene, picture, workload), workload.hits.copy(), done)


def save_png(image: NDArray[np.uint8], path: str | os.PathLike[str]) -> None:
    """Write a picture (rows, columns, 3) uint8 as PNG, whatever the name ends in."""
    with replaced(Path(path)) as part:
        Image.fromarray(image).save(part, format="PNG")


def shade(traced: Traced, hits: Ints, done: Flags | None = None) -> NDArray[np.uint8]:
    """The picture if rays hit ``hits`` (n,) int32.

    A ray whose hit is not the recorded one has lost its children: it shows its ambient light.
    """
    if traced.picture.render == PATH:
        light = light_of_roots(traced, hits)
        return in_bytes(_pixels(light, traced.picture, done))
    workload, lighting = traced.workload, _lighting(traced)
    colours = np.zeros((workload.n_rays, 3))
    as_recorded, first_shadows = hits == workload.hits, _first_shadows(workload)
    geometry, work = traced.geometry, work_for(traced.geometry.shapes)
    for start, rays in recorded_generations(traced):
        stop = start + len(rays.kinds)
        distances = workload.hit_distances[start:stop] * traced.frame.scale
        shadows = first_shadows[start:stop]
        _shade(
            geometry, lighting, rays, start, hits, as_recorded, distances, shadows, work, colours
        )
    _gather(colours, workload.kinds, workload.parents, hits, as_recorded, lighting.materials)
    return in_bytes(_pixels(colours, traced.picture, done))


def in_bytes(pixels: Floats) -> NDArray[np.uint8]:
    """Red, green and blue from 0 to 1 in 256 steps; what is brighter is cut off."""
    return np.rint(255 * np.clip(pixels, 0.0, 1.0)).astype(np.uint8)


def light(scene: Scene, picture: Picture, workload: Workload) -> Floats:
    """Red, green and blue of each pixel of traced paths, not cut off: (rows, columns, 3) float64.

    Raises WorkloadError if the workload is not of this scene and picture.
    """
    replayed = traced(scene, picture, workload)
    of_roots = light_of_roots(replayed, workload.hits.copy())
    return picture_of_roots(of_roots, workload.picture, workload.samples)


def _first_shadows(workload: Workload) -> Ints:
    """Number of each ray's first shadow ray, (n,) int32: it follows the other children."""
    spawned = workload.kinds != SHADOW
    before = np.zeros(workload.n_rays + 1, np.int32)
    np.cumsum(spawned, out=before[1:])
    first, after = workload.child_offsets[:-1], workload.child_offsets[1:]
    numbers: Ints = first + before[after] - before[first]
    return numbers


def _lighting(traced: Traced) -> Lighting:
    scene = traced.scene
    rows = [
        (*material.colour, material.kd, material.ks, material.shine, material.transmittance)
        for material in scene.materials
    ]
    lights, n = scene.lights, len(scene.lights)
    positions = np.array([light.position for light in lights], dtype=np.float64).reshape(-1, 3)
    colours = np.array([light.colour for light in lights], dtype=np.float64).reshape(-1, 3)
    surface_of = np.array([item.material for item in scene.objects], dtype=np.int64)
    return Lighting(
        materials=np.array(rows, dtype=np.float64).reshape(-1, 7)[surface_of],
        lights=traced.frame.points(positions),
        colours=colours * (math.sqrt(n) / (2 * n)) if n else colours,
        background=np.array(scene.background, dtype=np.float64),
        shadows=traced.picture.shadows,
    )


@njit
def _shade(
    geometry: Geometry,
    lighting: Lighting,
    rays: RayBatch,
    start: int,
    hits: Ints,
    as_recorded: NDArray[np.bool_],
    distances: Floats,
    shadows: Ints,
    work: Work,
    colours: Floats,
) -> None:
    """What each ray of a generation sees by itself, without what it reflects or refracts.

    ``shadows`` (n,) int32 is the number of each ray's first shadow ray.
    """
    for i in range(len(distances)):
        hit = hits[start + i]
        if rays.kinds[i] == SHADOW:
            continue
        colour = colours[start + i]
        if hit < 0:
            for c in range(3):
                colour[c] = lighting.background[c]
            continue
        material = lighting.materials[hit]
        for c in range(3):
            colour[c] = AMBIENT * material[3] * material[c]
        if as_recorded[start + i]:
            ray = ray_of(rays.origins, rays.directions, i)
            opaque = not geometry.transmits[hit]
            surface = surface_at(
                geometry.shapes, geometry.normals, hit, ray, distances[i], opaque, work
            )
            mirror = reflected(ray, surface)
            _light(lighting, material, surface, mirror, hits, shadows[i], colour)


@kernel
def _light(
    lighting: Lighting,
    material: Floats,
    surface: Surface,
    mirror: Vector,
    hits: Ints,
    shadow: int,
    colour: Floats,
) -> None:
    """Add to ``colour`` (3,) what each light gives that the surface faces and nothing blocks."""
    kd, ks, shine = material[3], material[4], material[5]
    for k in range(len(lighting.lights)):
        to_light = minus(vector(lighting.lights, k), surface.point)
        if not faces(surface, to_light):
            continue
        shadow += 1
        if lighting.shadows and hits[shadow - 1] >= 0:
            continue
        direction = normalised(to_light)
        diffuse = kd * dot(surface.lit, direction)
        along = dot(mirror, direction)
        before = dot(surface.normal, direction) > 0.0
        highlight = ks * along**shine if before and along > 0.0 else 0.0
        for c in range(3):
            colour[c] += lighting.colours[k, c] * (diffuse * material[c] + highlight)


@njit
def _gather(
    colours: Floats,
    kinds: NDArray[np.uint8],
    parents: Ints,
    hits: Ints,
    as_recorded: NDArray[np.bool_],
    materials: Floats,
) -> None:
    """Add to each ray what its children see, the last generation first."""
    # A child has the greater number, so what it sees is complete before its parent takes a share.
    for i in range(len(kinds) - 1, -1, -1):
        parent = parents[i]
        if kinds[i] != SHADOW and parent >= 0 and as_recorded[parent]:
            material = materials[hits[parent]]
            share = material[4] if kinds[i] == REFLECTED else material[6]
            for c in range(3):
                colours[parent, c] += share * colours[i, c]


def _pixels(colours: Floats, picture: Picture, done: Flags | None) -> Floats:
    """(rows, columns, 3) float64: a pixel is its centre, or the mean of its corners or samples."""
    if picture.samples != CORNERS:
        return picture_of_roots(colours[: picture.n_roots], picture.shape, picture.passes, done)
    samples = colours[: picture.n_roots].reshape(*picture.shape, 3)
    if done is not None:
        there = done.reshape(picture.shape)
        there = there[:-1, :-1] & there[:-1, 1:] & there[1:, :-1] & there[1:, 1:]
        return there[:, :, None] * _pixels(colours, picture, None)
    mean: Floats = (samples[:-1, :-1] + samples[:-1, 1:] + samples[1:, :-1] + samples[1:, 1:]) / 4
    return mean
