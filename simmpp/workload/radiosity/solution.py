"""What patches look like: a table, and a picture of their sides."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.scene.boxes import boxes_of
from simmpp.scene.columns import columns_of
from simmpp.workload.picture import Picture
from simmpp.workload.radiosity.room import Room
from simmpp.workload.trace.generations import first_generation
from simmpp.workload.trace.path.radiance import picture_of_roots
from simmpp.workload.trace.shading import in_bytes
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import Workload

Floats = NDArray[np.float64]
SAMPLES = 4
"""Rays through each pixel of a picture of patches, so that their edges are smooth."""
COLOURS = ("red", "green", "blue")


def drawn(room: Room, light: Floats) -> NDArray[np.uint8]:
    """A picture of sides of that light (2 N, 3), each of one colour.

    Its bytes are square roots of brightness, about as screens take them: what lamps light is far
    darker than they are.
    """
    view = Picture(
        resolution=room.settings.resolution,
        samples=SAMPLES,
        max_depth=1,
        shadows=False,
        reflection=False,
        refraction=False,
    )
    return in_bytes(np.sqrt(seen(room, view, light)))


def seen(room: Room, view: Picture, light: Floats) -> Floats:
    """Red, green and blue of each pixel of a ``view``, (rows, columns, 3) float64, not cut off."""
    scene, view = room.patches.scene, view.of(room.patches.scene)
    rays = first_generation(scene, view, room.frame)
    places = room.landed(rays, trace(scene, view).hits.copy())
    colours = np.where(places[:, None] >= 0, light[places], 0.0)
    return picture_of_roots(colours, view.shape, view.passes)


def table_of(room: Room, workload: Workload, light: Floats) -> dict[str, NDArray[Any]]:
    """A row for each patch: where it is, what it is of, how its front and its back look."""
    patches = room.patches
    centres = boxes_of(columns_of(patches.scene)).mean(axis=1)
    front, back = light[0::2].T, light[1::2].T
    hits = workload.hits[workload.hits >= 0]
    return {
        "object": np.arange(len(patches.areas)),
        "part": patches.parts,
        **dict(zip("xyz", centres.T, strict=True)),
        "area": patches.areas,
        **dict(zip(COLOURS, front, strict=True)),
        **{f"back_{colour}": light for colour, light in zip(COLOURS, back, strict=True)},
        "hits": np.bincount(hits, minlength=len(patches.areas)),
    }
