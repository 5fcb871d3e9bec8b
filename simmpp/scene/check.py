"""Could any renderer use this scene? Readers of files know; of scenes that a caller made, ask here.

Coordinates that are not finite are found where they are measured, by the tracer's frame.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.scene.columns import FLAT
from simmpp.scene.scene import Material, MeshPart, Polygon, Scene, SceneObject


def check_scene(scene: Scene) -> None:
    """Raise SceneError for a material, a colour or an object that makes no sense."""
    for what, problem in _problems(scene):
        if problem:
            raise SceneError(f"{what} {problem}", where=scene.name)


def _problems(scene: Scene) -> Iterator[tuple[str, str]]:
    """What is looked at, and what is wrong with it: nothing, mostly."""
    for number, material in enumerate(scene.materials):
        yield f"material {number}", _problem_of_material(material)
    for number, light in enumerate(scene.lights):
        yield f"the colour of light {number}", _problem_of_numbers(light.colour)
    yield "the background", _problem_of_numbers(scene.background)
    for number, obj in enumerate(scene.objects):
        if problem := _problem_of_object(obj, len(scene.materials)):
            yield f"object {number}", problem


def _problem_of_material(m: Material) -> str:
    numbers = (*m.colour, m.kd, m.ks, m.shine, m.transmittance, *m.emission)
    if problem := _problem_of_numbers(numbers):
        return problem
    if m.transmittance > 1:
        return f"has transmittance {m.transmittance:g}, expected at most 1"
    if m.transmits and not 0.0 < m.ior < math.inf:
        return f"transmits, its ior is {m.ior:g}, expected above 0"
    return ""


def _problem_of_numbers(numbers: Iterable[float]) -> str:
    wrong = [number for number in numbers if not 0 <= number < math.inf]
    return f"has the number {wrong[0]:g}, expected 0 or a finite number above" if wrong else ""


def _problem_of_object(obj: SceneObject, n_materials: int) -> str:
    if not 0 <= obj.material < n_materials:
        return f"has material {obj.material}, expected one of the {n_materials} materials"
    if isinstance(obj, FLAT):
        shape = np.shape(obj.vertices)
        if len(shape) != 2 or shape[1] != 3:
            return f"has vertices of shape {shape}, expected (n, 3)"
        if isinstance(obj, Polygon) and shape[0] < 3:
            return f"is a polygon of {shape[0]} vertices, expected at least 3"
    return _problem_of_faces(obj) if isinstance(obj, MeshPart) else ""


def _problem_of_faces(part: MeshPart) -> str:
    faces, n = np.asarray(part.faces), len(part.vertices)
    if faces.ndim != 2 or faces.shape[1] != 3 or not len(faces) or faces.dtype.kind not in "iu":
        return f"has faces of shape {faces.shape} {faces.dtype}, expected (m, 3) integers, m > 0"
    if faces.min() < 0 or faces.max() >= n:
        return f"has a face that names a vertex outside 0 ... {n - 1}"
    return ""
