"""The hash of everything that makes a workload, and so its name in the cache."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator

import numpy as np

from simmpp.common.code.source import source_digest
from simmpp.common.modules import TRACER
from simmpp.scene.columns import columns_of
from simmpp.scene.scene import Material, Scene
from simmpp.scene.wire import sizes_on_the_wire
from simmpp.workload.picture import PATH, Picture


def digest_of(scene: Scene, picture: Picture) -> str:
    """Hexadecimal SHA-256 of geometry, lights, camera, picture and the source of the tracer.

    Of a material only what spawns rays counts; names, colours and the background do not.
    """
    return hashed(_parts(scene, picture))


def hashed(parts: Iterable[memoryview]) -> str:
    """Hexadecimal SHA-256 of parts, each with its length."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.nbytes.to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


def _parts(scene: Scene, picture: Picture) -> Iterator[memoryview]:
    picture = picture.of(scene)
    settings = {**vars(picture), "resolution": picture.pixels, "samples": picture.shape}
    told = sorted({**settings, "passes": picture.passes}.items())
    yield memoryview(repr((source_digest(TRACER), told)).encode())
    camera = scene.camera
    yield _numbers(*camera.eye, *camera.at, *camera.up, camera.angle_degrees)
    yield _numbers(*(x for light in scene.lights if picture.shadows for x in light.position))
    spawned = [_spawning(material, picture) for material in scene.materials]
    objects = columns_of(scene)
    of_materials = np.array(spawned, dtype=np.float64)  # (m, ...), or (0,) of nothing
    yield of_materials[objects.materials].data
    yield from parts_of_geometry(scene)


def parts_of_geometry(scene: Scene) -> Iterator[memoryview]:
    """What tells the objects of one scene from those of another, but for their materials."""
    objects = columns_of(scene)
    yield sizes_on_the_wire(objects).data
    yield from (objects.kinds.data, objects.spheres.data, objects.cones.data)
    yield from (objects.n_vertices.data, objects.vertices.data)
    yield from (objects.n_faces.data, objects.faces.data)


def _spawning(m: Material, picture: Picture) -> tuple[float, ...]:
    """What decides which rays a hit on the material spawns."""
    # Without refraction no ray reads the index, so it must not tell two scenes apart.
    rays = (m.reflects, m.transmits, m.ior if m.transmits else 1.0)
    chances = (*m.colour, m.kd, m.ks, m.transmittance, *m.emission)
    return (*rays, *chances) if picture.render == PATH else rays


def _numbers(*numbers: float) -> memoryview:
    return np.array(numbers, dtype=np.float64).data
