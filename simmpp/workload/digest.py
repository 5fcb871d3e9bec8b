"""The hash of everything that makes a workload, and so its name in the cache."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Iterator

import numpy as np

from simmpp.common.compiled import source_digest
from simmpp.common.modules import TRACER
from simmpp.scene.scene import Cone, MeshPart, Scene, SceneObject, Sphere
from simmpp.scene.wire import bytes_on_the_wire
from simmpp.workload.picture import Picture


def digest_of(scene: Scene, picture: Picture) -> str:
    """Hexadecimal SHA-256 of geometry, lights, camera, picture and the source of the tracer.

    Of a material only what spawns rays counts; names, colours and the background do not.
    """
    digest = hashlib.sha256()
    for part in _parts(scene, picture):
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


def _parts(scene: Scene, picture: Picture) -> Iterator[bytes]:
    picture = picture.of(scene)
    _, *settings = dataclasses.astuple(picture)
    yield repr((source_digest(TRACER), picture.pixels, *settings)).encode()
    camera = scene.camera
    yield _bytes(*camera.eye, *camera.at, *camera.up, camera.angle_degrees)
    yield _bytes(*(x for light in scene.lights if picture.shadows for x in light.position))
    # Without refraction no ray reads the index, so it must not tell two scenes apart.
    spawned = [(m.reflects, m.transmits, m.ior if m.transmits else 1.0) for m in scene.materials]
    for obj in scene.objects:
        yield obj.kind.encode()
        yield _bytes(bytes_on_the_wire(obj), *spawned[obj.material])
        yield from _geometry(obj)


def _geometry(obj: SceneObject) -> Iterator[bytes]:
    if isinstance(obj, Sphere):
        yield _bytes(*obj.centre, obj.radius)
    elif isinstance(obj, Cone):
        yield _bytes(*obj.base, obj.base_radius, *obj.apex, obj.apex_radius)
    else:
        yield np.asarray(obj.vertices, dtype="<f8").tobytes()
        if isinstance(obj, MeshPart):
            yield np.asarray(obj.faces, dtype="<i8").tobytes()


def _bytes(*numbers: float) -> bytes:
    return np.array(numbers, dtype="<f8").tobytes()
