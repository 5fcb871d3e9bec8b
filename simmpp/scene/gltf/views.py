"""The cameras and lights of a file, where its nodes put them.

A tracer of Whitted's has pinhole cameras and point lights. Source: Khronos, "glTF 2.0
Specification", 3.10, and KHR_lights_punctual, as to which way they look and what scales leave.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.common.units import counted, shown
from simmpp.scene.gltf.document import item
from simmpp.scene.gltf.schema import Document
from simmpp.scene.node import as_vector, seen_through, turned
from simmpp.scene.scene import Camera, Floats, Light

LOCAL = Camera(eye=(0.0, 0.0, 0.0), at=(0.0, 0.0, -1.0), up=(0.0, 1.0, 0.0))
"""A camera of glTF as its node sees it."""
TO_SUN = (0.0, 0.0, 1.0)
"""Against the way of light."""
Cameras = tuple[tuple[str, Camera], ...]


def cameras_in(document: Document, worlds: dict[int, Floats]) -> tuple[Cameras, tuple[str, ...]]:
    """Cameras in the order of their nodes, called as these are, and why others were left out."""
    found, notes = [], []
    for at, world in worlds.items():
        node = document.nodes[at]
        if node.camera is None:
            continue
        described = item(document.cameras, node.camera, "cameras")
        name = node.name or described.name or str(at)
        if described.perspective is None:
            if described.type == "perspective":
                problem = "expected perspective with its yfov"
                raise SceneError(f"cameras[{node.camera}]: {problem}")
            notes.append(f"camera {shown(name)} is left out: {described.type}, not perspective")
            continue
        camera = _at_distance(seen_through(LOCAL, world))
        yfov = described.perspective.yfov
        if not 0 < yfov < math.pi:
            problem = f"cameras[{node.camera}].perspective.yfov: value {yfov:g}"
            raise SceneError(f"{problem}: expected radians above 0 and below pi")
        camera = Camera(camera.eye, camera.at, camera.up, math.degrees(yfov))
        if camera.aims:
            found.append((name, camera))
        else:
            notes.append(f"camera {shown(name)} is left out: its node has no size to look along")
    return tuple(found), tuple(notes)


def _at_distance(camera: Camera) -> Camera:
    """The same view of a point so far away that the eye's roundings don't turn it."""
    eye = np.array(camera.eye)
    ahead = np.subtract(camera.at, eye)
    length = math.hypot(*ahead)
    if not 0 < length < math.inf:
        return camera
    return Camera(camera.eye, as_vector(eye + ahead * (max(1.0, *abs(eye)) / length)), camera.up)


def lights_in(
    document: Document, worlds: dict[int, Floats]
) -> tuple[tuple[Light, ...], tuple[Light, ...], tuple[str, ...]]:
    """Point lights, suns, and what is not as the file says.

    The brightest of either is 1: their units (candela, lux) say nothing of one another.
    """
    lights, suns, spots = [], [], 0
    notes: list[str] = []
    unknown: dict[str, None] = {}
    for kind, colour, world in _placed(document, worlds):
        if kind == "directional":
            towards = turned(TO_SUN, world)
            if any(towards):
                suns.append(Light(towards, colour))
            else:
                notes.append("a directional light is left out: its node has no size to shine along")
        elif kind in ("point", "spot"):
            lights.append(Light(as_vector(world[:3, 3]), colour))
            spots += kind == "spot"
        else:
            unknown[kind] = None
    notes += [f"lights of type {shown(kind)} are left out" for kind in unknown]
    if spots:
        notes.append(f"{counted(spots, 'spot light')} without a cone: seen as a point light is")
    return _relative(lights), _relative(suns), tuple(notes)


def _placed(
    document: Document, worlds: dict[int, Floats]
) -> Iterator[tuple[str, tuple[float, float, float], Floats]]:
    """Type, colour times intensity, and place of each light."""
    for at, world in worlds.items():
        placed = document.nodes[at].extensions.light
        if placed is not None:
            lights = document.extensions.punctual.lights
            light = item(lights, placed.light, "KHR_lights_punctual.lights")
            if min(light.color) < 0:
                problem = f"KHR_lights_punctual.lights[{placed.light}].color: value {light.color}"
                raise SceneError(f"{problem}: expected numbers from 0")
            red, green, blue = (share * light.intensity for share in light.color)
            yield light.type, (red, green, blue), world


def _relative(lights: list[Light]) -> tuple[Light, ...]:
    most = max((max(light.colour) for light in lights), default=0.0)
    if not 0 < most < math.inf:
        return tuple(lights)
    return tuple(
        Light(light.position, as_vector(np.array(light.colour) / most)) for light in lights
    )
