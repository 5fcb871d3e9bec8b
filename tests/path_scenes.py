"""Small scenes for path tracing: closed rooms, and a lamp over a floor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simmpp.scene.scene import Camera, Light, Material, Polygon, Scene, SceneObject, Sphere

Corner = tuple[float, float, float]


def quad(*corners: Corner, material: int = 0) -> Polygon:
    return Polygon(np.array(corners, np.float64), None, material)


def walls(low: Corner, high: Corner, materials: Sequence[int]) -> list[SceneObject]:
    """Six walls: at low y, high y, low x, high x, low z, high z."""
    (x, y, z), (X, Y, Z) = low, high
    corners = [
        ((x, y, z), (X, y, z), (X, y, Z), (x, y, Z)),
        ((x, Y, z), (X, Y, z), (X, Y, Z), (x, Y, Z)),
        ((x, y, z), (x, Y, z), (x, Y, Z), (x, y, Z)),
        ((X, y, z), (X, Y, z), (X, Y, Z), (X, y, Z)),
        ((x, y, z), (X, y, z), (X, Y, z), (x, Y, z)),
        ((x, y, Z), (X, y, Z), (X, Y, Z), (x, Y, Z)),
    ]
    return [quad(*c, material=m) for c, m in zip(corners, materials, strict=True)]


INSIDE = Camera((5.0, 0.3, 5.0), (5.0, 10.0, 4.5), angle_degrees=80.0)


def furnace(rho: float, *, glossy: bool = False) -> Scene:
    """A closed room in which everything shines with 1 and keeps ``rho``, be it matt or not."""
    shine = (1.0, 1.0, 1.0)
    matt = Material((rho, rho, rho), emission=shine)
    half = Material((0.5, 0.5, 0.5), kd=rho, ks=rho / 2, emission=shine)
    glass = Material(shine, 0.0, rho / 4, transmittance=rho * 0.75, ior=1.5, emission=shine)
    objects = walls((0, 0, 0), (10, 10, 10), (0, 1, 0, 0, 1, 0) if glossy else (0,) * 6)
    if glossy:
        objects += [Sphere((3, 6, 3), 2, 2), Sphere((7, 7, 6), 1.5, 1)]
    return Scene("furnace", tuple(objects), (matt, half, glass), (), INSIDE)


def room(lights: Sequence[Light] = ()) -> Scene:
    """Red, green and white walls, a lamp in the ceiling, a mirror, glass, and a matt mirror."""
    materials = (
        Material((0.73, 0.73, 0.73)),
        Material((0.65, 0.05, 0.05)),
        Material((0.12, 0.45, 0.15)),
        Material((0.5, 0.5, 0.5), emission=(15.0, 12.0, 7.0)),
        Material((1.0, 1.0, 1.0), kd=0.0, ks=0.95),
        Material((1.0, 1.0, 1.0), kd=0.0, ks=0.05, transmittance=0.95, ior=1.5),
        Material((0.3, 0.5, 0.9), kd=0.6, ks=0.3),
    )
    lamp = quad((3.5, 3.5, 9.99), (6.5, 3.5, 9.99), (6.5, 6.5, 9.99), (3.5, 6.5, 9.99), material=3)
    balls = [Sphere((3, 6.5, 2), 2, 4), Sphere((7, 4, 1.8), 1.8, 5), Sphere((7.5, 8, 1.5), 1.5, 6)]
    objects = (*walls((0, 0, 0), (10, 10, 10), (0, 0, 1, 2, 0, 0)), lamp, *balls)
    return Scene("room", objects, materials, tuple(lights), INSIDE)


LAMP: list[Corner] = [(-1, -2, 3), (2, -2, 3), (2, 1.5, 3), (-1, 1.5, 3)]


def lamp_over_floor() -> Scene:
    """A lamp of radiance 2, 1 and 0.5; the camera looks at one point of a floor, the origin."""
    materials = Material((0.8, 0.5, 0.2)), Material((0.0, 0.0, 0.0), emission=(2.0, 1.0, 0.5))
    floor = quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0))
    camera = Camera((8.0, 0.0, 6.0), (0.0, 0.0, 0.0), angle_degrees=1e-4)
    return Scene("lamp", (floor, quad(*LAMP, material=1)), materials, (), camera)


def irradiance(corners: Sequence[Corner]) -> float:
    """Of a floor at the origin, in units of the radiance: Lambert's polygon (1760, Photometria).

    Half the sum over the edges of the angle that each subtends, times the cosine of the normal of
    the triangle that it makes with the point against the floor's.
    """
    total, n = 0.0, len(corners)
    for i in range(n):
        a = np.array(corners[i]) / np.linalg.norm(corners[i])
        b = np.array(corners[(i + 1) % n]) / np.linalg.norm(corners[(i + 1) % n])
        across = np.cross(a, b)
        total += np.arccos(a @ b) * across[2] / np.linalg.norm(across)
    return abs(total) / 2
