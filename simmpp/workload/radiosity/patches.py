"""A scene cut into patches: flat quadrilaterals and triangles, each an object of its own."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError, SceneError
from simmpp.scene.check import check_scene
from simmpp.scene.columns import POLYGON, columns_of
from simmpp.scene.scene import Polygon, Scene
from simmpp.scene.tiling import faces_of
from simmpp.workload.radiosity.faces import FLAT, Faces, areas_of, halved, joined, lengths
from simmpp.workload.radiosity.settings import Radiosity

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
MOST_PATCHES = 2**24
"""So that what is made of them fits into memory."""


class Patches(NamedTuple):
    """N patches; both sides of each shine and reflect alike."""

    scene: Scene
    """The same view of the same materials, each object a patch."""
    areas: Floats
    """(N,) float64, in the scene's units squared."""
    parts: Ints
    """(N,) int64: the object of the whole scene that the patch is of."""
    emitted: Floats
    """(N, 3) float64: red, green and blue that it shines with by itself ..."""
    reflectance: Floats
    """(N, 3) float64: ... and what it sends on of what reaches it."""


def patches_of(scene: Scene, settings: Radiosity) -> Patches:
    """The patches of a scene.

    Raises
    ------
    SceneError
        The scene makes no sense, an object is no polygon or mesh or has no area, a material
        reflects more than there is, or nothing shines.
    ConfigError
        There are more than MOST_PATCHES.
    """
    check_scene(scene)
    faces = joined(_triangles(scene))
    _refuse_no_area(scene, faces)
    faces = _cut(faces, settings.patches)
    materials = columns_of(scene).materials[faces.parts]
    emitted, reflectance = _of_materials(scene)
    if not (emitted[materials] > 0).any():
        problem = "nothing shines: expected a material with Ke (OBJ) or emissiveFactor (glTF)"
        raise SceneError(problem, where=scene.name)
    objects = tuple(
        Polygon(corners[: 4 if is_quad else 3], None, material)
        for corners, is_quad, material in zip(
            faces.points, faces.is_quad.tolist(), materials.tolist(), strict=True
        )
    )
    cut = dataclasses.replace(scene, objects=objects)
    return Patches(cut, areas_of(faces), faces.parts, emitted[materials], reflectance[materials])


def _cut(faces: Faces, most: Fraction | float) -> Faces:
    """Faces in halves until none is larger; ConfigError for too many."""
    areas = areas_of(faces)
    limit = math.fsum(areas.tolist()) * float(most) if isinstance(most, Fraction) else most
    if float(np.ceil(areas / limit).sum()) > MOST_PATCHES:
        problem = f"there would be more than {MOST_PATCHES} patches: expected a larger area"
        raise ConfigError(problem, where="radiosity.patches")
    while (areas > limit).any():
        faces = halved(faces, areas > limit)
        areas = areas_of(faces)
    return faces


def _triangles(scene: Scene) -> Faces:
    columns = columns_of(scene)
    curved = np.flatnonzero(columns.kinds < POLYGON)
    if len(curved):
        problem = f"object {curved[0]} is curved: expected polygons and meshes, patches are flat"
        raise SceneError(problem, where=scene.name)
    faces, parts = faces_of(columns)
    points = columns.vertices[faces]
    if not np.isfinite(points).all():
        bad = int(parts[~np.isfinite(points).all(axis=(1, 2))][0])
        raise SceneError(f"object {bad} has a coordinate that is not finite", where=scene.name)
    padded = np.concatenate([points, points[:, 2:]], axis=1)
    return Faces(padded, np.zeros(len(points), np.bool_), parts.astype(np.int64))


def _refuse_no_area(scene: Scene, faces: Faces) -> None:
    areas = areas_of(faces)
    sides = lengths(np.roll(faces.points, -1, axis=1) - faces.points).max(axis=1, initial=0.0)
    flat = areas <= FLAT * sides * sides
    if flat.any():
        problem = f"object {faces.parts[flat][0]} has a patch of no area"
        raise SceneError(problem, where=scene.name)


def _of_materials(scene: Scene) -> tuple[Floats, Floats]:
    """Emitted light and reflectance (m, 3) of each material; SceneError for more than all."""
    emitted = np.array([m.emission for m in scene.materials], np.float64).reshape(-1, 3)
    shares = [[m.kd * part for part in m.colour] for m in scene.materials]
    reflectance = np.array(shares, np.float64).reshape(-1, 3)
    if (reflectance > 1).any():
        number = int((reflectance > 1).any(axis=1).argmax())
        told = f"material {number} reflects {reflectance[number].max():g} of what reaches it"
        raise SceneError(f"{told}: expected at most 1", where=scene.name)
    return emitted, reflectance
