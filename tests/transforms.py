"""Scenes put elsewhere: moved, scaled and turned with their camera and lights."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from simmpp.scene.scene import Cone, Light, Scene, SceneObject, Sphere, Vector

Place = Callable[[np.ndarray], np.ndarray]
"""Points (..., 3) float64 to where they go."""


def moved(scene: Scene, offset: Vector) -> Scene:
    """Everything moved by ``offset``."""
    return placed(scene, lambda points: points + np.array(offset), size=1.0)


def scaled(scene: Scene, size: float) -> Scene:
    """Everything ``size`` times as large, seen from the coordinates' origin."""
    return placed(scene, lambda points: points * size, size=size)


def turned(scene: Scene, axis: Vector, angle: float) -> Scene:
    """Everything turned about an axis through the coordinates' origin by ``angle`` radians."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across
    there = placed(scene, lambda points: points @ matrix.T, size=1.0)
    up = _vector(matrix @ np.array(scene.camera.up))
    return dataclasses.replace(there, camera=dataclasses.replace(there.camera, up=up))


def placed(scene: Scene, place: Place, *, size: float) -> Scene:
    """Every point where ``place`` puts it, every radius ``size`` times as large."""

    def at(point: Vector) -> Vector:
        return _vector(place(np.array(point)))

    camera = dataclasses.replace(scene.camera, eye=at(scene.camera.eye), at=at(scene.camera.at))
    return dataclasses.replace(
        scene,
        objects=tuple(_placed(item, place, at, size) for item in scene.objects),
        lights=tuple(Light(at(light.position), light.colour) for light in scene.lights),
        camera=camera,
    )


def _placed(
    item: SceneObject, place: Place, at: Callable[[Vector], Vector], size: float
) -> SceneObject:
    if isinstance(item, Sphere):
        return dataclasses.replace(item, centre=at(item.centre), radius=item.radius * size)
    if isinstance(item, Cone):
        radii = item.base_radius * size, item.apex_radius * size
        return Cone(at(item.base), radii[0], at(item.apex), radii[1], item.material)
    return dataclasses.replace(item, vertices=place(item.vertices))


def _vector(point: np.ndarray) -> Vector:
    x, y, z = (float(coordinate) for coordinate in point)
    return x, y, z
