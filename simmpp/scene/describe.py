"""What a scene consists of, as plain data to print or to write as JSON."""

from __future__ import annotations

from collections import Counter
from typing import Any, get_args

import numpy as np
import pandas as pd

from simmpp.scene.boxes import boxes_of, scene_box
from simmpp.scene.columns import Columns, Counts, columns_of
from simmpp.scene.scene import Camera, Light, Material, Scene, SceneObject
from simmpp.scene.tiling import faces_of
from simmpp.scene.wire import sizes_on_the_wire


def describe(scene: Scene) -> dict[str, Any]:
    """Counts, sizes, bounds, materials, lights and camera of a scene.

    Only str, int, float, bool, list and dict. ``objects`` counts by kind, without the kinds that
    don't occur; ``triangles`` leaves out spheres and cones, which have none; ``reflecting`` and
    ``transmitting`` count objects.
    """
    objects, columns = scene.objects, columns_of(scene)
    kinds = Counter(obj.kind for obj in objects)
    surfaces = [scene.materials[obj.material] for obj in objects]
    low, high = scene_box(objects).tolist() if objects else (None, None)
    return {
        "name": scene.name,
        "n_objects": len(objects),
        "objects": {of.kind: kinds[of.kind] for of in get_args(SceneObject) if kinds[of.kind]},
        "triangles": int(_n_triangles(columns).sum()),
        "bytes": int(sizes_on_the_wire(columns).sum()),
        "box": {"low": low, "high": high},
        "reflecting": sum(surface.reflects for surface in surfaces),
        "transmitting": sum(surface.transmits for surface in surfaces),
        "materials": _materials(scene),
        "lights": [_plain(light) for light in scene.lights],
        "view": scene.origin.view,
        "cameras": [name for name, _ in scene.origin.cameras],
        "notes": list(scene.origin.notes),
        # No renderer here has a near plane.
        "camera": {k: v for k, v in _plain(scene.camera).items() if k != "hither"},
        "background": list(scene.background),
    }


def object_table(scene: Scene) -> pd.DataFrame:
    """One row per object, by id.

    Columns ``id, kind, name, material, triangles, bytes``, and the box ``x_low, y_low, z_low,
    x_high, y_high, z_high`` in scene units.
    """
    objects = scene.objects
    columns = columns_of(scene)
    bounds = boxes_of(columns).reshape(-1, 6)
    table: dict[str, Any] = {
        "id": np.arange(len(objects)),
        "kind": [obj.kind for obj in objects],
        "name": [getattr(obj, "name", "") for obj in objects],
        "material": [obj.material for obj in objects],
        "triangles": _n_triangles(columns),
        "bytes": sizes_on_the_wire(columns),
    }
    corners = [f"{axis}_{end}" for end in ("low", "high") for axis in "xyz"]
    return pd.DataFrame(table | dict(zip(corners, bounds.T, strict=True)))


def _n_triangles(columns: Columns) -> Counts:
    """(N,) int64; 0 for spheres and cones."""
    _, owners = faces_of(columns)
    return np.bincount(owners, minlength=len(columns.kinds))


def _materials(scene: Scene) -> list[dict[str, Any]]:
    users = Counter(obj.material for obj in scene.objects)
    return [
        {
            "id": i,
            "n_objects": users[i],
            **_plain(material),
            "reflects": material.reflects,
            "transmits": material.transmits,
        }
        for i, material in enumerate(scene.materials)
    ]


def _plain(thing: Material | Light | Camera) -> dict[str, Any]:
    """Its fields, vectors as lists."""
    fields = vars(thing).items()
    return {name: list(value) if isinstance(value, tuple) else value for name, value in fields}
