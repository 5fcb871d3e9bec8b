"""What a scene consists of, as plain data to print or to write as JSON."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pandas as pd

from simmpp.scene.boxes import boxes, scene_box
from simmpp.scene.scene import Scene
from simmpp.scene.triangles import n_triangles
from simmpp.scene.wire import bytes_on_the_wire

KINDS = ("sphere", "cone", "polygon", "mesh")


def describe(scene: Scene) -> dict[str, Any]:
    """Counts, sizes, bounds, materials, lights and camera of a scene.

    Only str, int, float, bool, list and dict. ``objects`` counts by kind, without the kinds that
    don't occur; ``triangles`` leaves out spheres and cones, which have none; ``reflecting`` and
    ``transmitting`` count objects.
    """
    items = scene.objects
    kinds = Counter(item.kind for item in items)
    surfaces = [scene.materials[item.material] for item in items]
    low, high = scene_box(items).tolist() if items else (None, None)
    return {
        "name": scene.name,
        "n_objects": len(items),
        "objects": {kind: kinds[kind] for kind in KINDS if kinds[kind]},
        "triangles": sum(map(n_triangles, items)),
        "bytes": sum(map(bytes_on_the_wire, items)),
        "box": {"low": low, "high": high},
        "reflecting": sum(surface.reflects for surface in surfaces),
        "transmitting": sum(surface.transmits for surface in surfaces),
        "materials": _materials(scene),
        "lights": [
            {"position": list(light.position), "colour": list(light.colour)}
            for light in scene.lights
        ],
        "camera": _camera(scene),
        "background": list(scene.background),
    }


def object_table(scene: Scene) -> pd.DataFrame:
    """One row per object, by id.

    Columns ``id, kind, name, material, triangles, bytes``, and the box ``x_low, y_low, z_low,
    x_high, y_high, z_high`` in scene units.
    """
    items = scene.objects
    bounds = boxes(items).reshape(-1, 6)
    table: dict[str, Any] = {
        "id": np.arange(len(items)),
        "kind": [item.kind for item in items],
        "name": [getattr(item, "name", "") for item in items],
        "material": [item.material for item in items],
        "triangles": [n_triangles(item) for item in items],
        "bytes": [bytes_on_the_wire(item) for item in items],
    }
    corners = [f"{axis}_{end}" for end in ("low", "high") for axis in "xyz"]
    return pd.DataFrame(table | dict(zip(corners, bounds.T, strict=True)))


def _materials(scene: Scene) -> list[dict[str, Any]]:
    users = Counter(item.material for item in scene.objects)
    return [
        {
            "id": i,
            "n_objects": users[i],
            "colour": list(material.colour),
            "kd": material.kd,
            "ks": material.ks,
            "shine": material.shine,
            "transmittance": material.transmittance,
            "ior": material.ior,
            "reflects": material.reflects,
            "transmits": material.transmits,
        }
        for i, material in enumerate(scene.materials)
    ]


def _camera(scene: Scene) -> dict[str, Any]:
    camera = scene.camera
    return {
        "eye": list(camera.eye),
        "at": list(camera.at),
        "up": list(camera.up),
        "angle_degrees": camera.angle_degrees,
        "resolution": list(camera.resolution),
    }
