"""Objects of an NFF text: whole runs of those that are spelled alike, else one.

What a run leaves is read word by word, so that every mistake is told at its line.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.nff_words import LARGEST, Words
from simmpp.scene.scene import Cone, Floats, Polygon, SceneObject, Sphere

MAX_VERTICES = 1_000_000
"""Largest polygon read; the SPD's largest has 144 vertices."""


def spheres(words: Words, material: int) -> Sequence[SceneObject]:
    """Those that follow after the ``s`` that was read, one at least, as all functions here."""
    rows = _alike(words, ["s"], 4, lambda rows: rows[:, 3] != 0)
    if len(rows):
        rows[:, 3] = np.abs(rows[:, 3])
        x, y, z, radii = rows.T.tolist()
        return [
            Sphere(*numbers, material)
            for numbers in zip(zip(x, y, z, strict=True), radii, strict=True)
        ]
    centre = words.vector("the centre of a sphere")
    radius = abs(words.number("the radius of a sphere"))
    if radius == 0:
        words.fail("a sphere needs a radius other than 0")
    return [Sphere(centre, radius, material)]


def cones(words: Words, material: int) -> Sequence[SceneObject]:
    """Cones and cylinders, after ``c``."""
    rows = _alike(words, ["c"], 8, _are_cones)
    if len(rows):
        rows[:, [3, 7]] = np.abs(rows[:, [3, 7]])
        x, y, z, radii, u, v, w, apex_radii = rows.T.tolist()
        bases, apexes = zip(x, y, z, strict=True), zip(u, v, w, strict=True)
        of_cones = zip(bases, radii, apexes, apex_radii, strict=True)
        return [Cone(*numbers, material) for numbers in of_cones]
    base = words.vector("the base of a cone")
    base_radius = words.number("the base radius of a cone")
    apex = words.vector("the apex of a cone")
    apex_radius = words.number("the apex radius of a cone")
    if base_radius == 0 and apex_radius == 0:
        words.fail("a cone needs a radius other than 0 at one end")
    if base_radius * apex_radius < 0:
        words.fail("the radii of a cone must have the same sign")
    if math.dist(base, apex) == 0:
        words.fail("a cone needs a length: its base and apex are the same point")
    return [Cone(base, abs(base_radius), apex, abs(apex_radius), material)]


def polygons(words: Words, material: int) -> Sequence[SceneObject]:
    """Polygons, after ``p``."""
    n = words.count("the number of vertices of a polygon", 3, MAX_VERTICES)
    rows = _alike(words, ["p", words.last], 3 * n)
    if not len(rows):
        rows = np.array([words.numbers(3 * n, "a vertex of a polygon")])
    return [Polygon(vertices, None, material) for vertices in rows.reshape(-1, n, 3)]


def patches(words: Words, material: int) -> Sequence[SceneObject]:
    """Polygons with a normal at each vertex, after ``pp``."""
    n = words.count("the number of vertices of a patch", 3, MAX_VERTICES)
    rows = _alike(words, ["pp", words.last], 6 * n, _have_normals)
    if not len(rows):
        rows = np.array([words.numbers(6 * n, "a vertex or normal of a patch")])
        if not _have_normals(rows)[0]:
            words.fail("a vertex normal of a patch has no length")
    vertices, normals = np.moveaxis(rows.reshape(-1, n, 2, 3), 2, 0).copy()
    return [Polygon(*pair, material) for pair in zip(vertices, normals, strict=True)]


def _are_cones(rows: Floats) -> NDArray[np.bool_]:
    a, b = rows[:, 3], rows[:, 7]
    is_long = np.any(rows[:, :3] != rows[:, 4:7], axis=1)
    usable: NDArray[np.bool_] = ((a != 0) | (b != 0)) & ~(a * b < 0) & is_long
    return usable


def _have_normals(rows: Floats) -> NDArray[np.bool_]:
    normals = rows.reshape(len(rows), -1, 2, 3)[:, :, 1]
    have_length: NDArray[np.bool_] = np.any(normals != 0, axis=2)
    return np.logical_and.reduce(have_length, axis=1)


def _alike(
    words: Words,
    head: list[str],
    n: int,
    are_usable: Callable[[Floats], NDArray[np.bool_]] | None = None,
) -> Floats:
    """The numbers of objects that follow, (k, n), the first of which has had its ``head`` read.

    Each has the same words as its head and then ``n`` numbers; the run ends before the first that
    is not usable. The words of the run are read then. k may be 0: the first has to be looked at.
    """
    step = len(head) + n
    start = words.position - len(head)
    k = _count(words.words, start, head, step)
    while k:
        spelled = words.words[start : start + k * step]
        for word in range(len(head)):
            del spelled[:: step - word]
        try:
            rows = np.fromiter(map(float, spelled), np.float64, k * n).reshape(k, n)
        except ValueError:
            k //= 2  # before what is no number there may be many that are
            continue
        usable = (np.abs(rows) <= LARGEST).all(axis=1)
        if are_usable:
            usable &= are_usable(rows)
        k = k if usable.all() else int(usable.argmin())
        words.position = max(words.position, start + k * step)
        return rows[:k]
    return np.empty((0, n))


def _count(words: list[str], start: int, head: list[str], step: int) -> int:
    """How many objects of ``step`` words there are from one to the next, all with that head."""
    at, width = start, len(head)
    while words[at : at + width] == head:
        at += step
    return (min(at, len(words)) - start) // step
