"""What paths read of a scene and of the picture's settings, as arrays for compiled code."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import SceneError
from simmpp.scene.columns import POLYGON, columns_of
from simmpp.scene.scene import Material, Scene
from simmpp.workload.picture import Picture
from simmpp.workload.trace.camera import FAR
from simmpp.workload.trace.frame import Frame
from simmpp.workload.trace.geometry import Geometry

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


class Lamps(NamedTuple):
    """What light is sampled of: points, and triangles that shine."""

    points: Floats
    """(L, 3) float64, normalised."""
    point_colours: Floats
    """(L, 3) float64: as bright wherever they are, as in Whitted's pictures."""
    rows: NDArray[np.int64]
    """(K,) int64: the rows of ``Shapes.surfaces`` of triangles that shine ..."""
    objects: Ints
    """(K,) int32: ... their objects ..."""
    powers: Floats
    """(K,) float64: ... and sums of area times brightness up to each of them."""


class Paths(NamedTuple):
    """How paths of one picture go on, and what they bring home; M materials."""

    materials: Floats
    """(M, 9) float64: diffuse red, green and blue, the greatest of them, mirrored and transmitted
    shares, emitted red, green and blue."""
    material_of: Ints
    """(N,) int32 of each object."""
    sampled: NDArray[np.bool_]
    """(N,) bool: what it emits is counted by light samples, and not where a diffuse ray hits it."""
    lamps: Lamps
    background: Floats
    """(3,) float64."""
    seed: int
    depth: int
    roulette: int
    """Depth from which chance may end a path."""
    shadows: bool
    reflection: bool
    refraction: bool


def paths_of(scene: Scene, picture: Picture, frame: Frame, geometry: Geometry) -> Paths:
    """The rules of ``picture``; SceneError for a light that can't be reckoned with."""
    columns = columns_of(scene)
    material_of = columns.materials.astype(np.int32)
    materials = np.array([_row(m) for m in scene.materials], np.float64).reshape(-1, 9)
    shines = np.flatnonzero((materials[:, 6:] > 0).any(axis=1))
    sampled = np.isin(material_of, shines) & (columns.kinds >= POLYGON) & picture.shadows
    return Paths(
        materials=materials,
        material_of=material_of,
        sampled=sampled,
        lamps=_lamps(scene, picture, frame, geometry, materials[material_of, 6:], sampled),
        background=np.array(scene.background, np.float64),
        seed=picture.seed,
        depth=picture.depth,
        roulette=picture.roulette,
        shadows=picture.shadows,
        reflection=picture.reflection,
        refraction=picture.refraction,
    )


def _row(material: Material) -> tuple[float, ...]:
    """Shares that sum to more than 1 are scaled to it: a closed room would never get dark."""
    diffuse = [material.kd * share for share in material.colour]
    shares = (*diffuse, max(diffuse), material.ks, material.transmittance)
    total = max(1.0, sum(shares[3:]))
    return (*(share / total for share in shares), *material.emission)


def _lamps(
    scene: Scene,
    picture: Picture,
    frame: Frame,
    geometry: Geometry,
    emitted: Floats,
    sampled: NDArray[np.bool_],
) -> Lamps:
    lights = scene.lights if picture.shadows else ()
    points = np.array([light.position for light in lights], np.float64).reshape(-1, 3)
    colours = np.array([light.colour for light in lights], np.float64).reshape(-1, 3)
    placed, n = frame.points(points), len(lights)
    if not (np.abs(placed) < FAR).all():
        raise SceneError("a light is not finite, or too far away", where=scene.name)
    n_rows = np.maximum(geometry.n_triangles, 1)
    owners = np.repeat(np.arange(len(n_rows), dtype=np.int32), n_rows)
    rows = np.flatnonzero(sampled[owners])
    u, v = geometry.shapes.surfaces[rows, 3:6], geometry.shapes.surfaces[rows, 6:]
    x, y, z = np.cross(u, v).T
    areas = np.sqrt(x * x + y * y + z * z) / 2
    return Lamps(
        points=placed,
        # As the SPD suggests: several lights together are not as bright as each alone would be.
        point_colours=colours * (math.sqrt(n) / (2 * n)) if n else colours,
        rows=rows,
        objects=owners[rows],
        powers=np.cumsum(areas * emitted[owners[rows]].max(axis=1, initial=0.0)),
    )
