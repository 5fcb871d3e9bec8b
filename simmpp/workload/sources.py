"""The doors to scenes and rays: the key ``scene`` with its short forms.

Every door takes the same and says the same of a mistake: a configuration, ``simmpp scene SPEC``,
``simmpp workload SPEC``, ``simmpp.load_scene(spec)``. A further kind of workload is a RaySource in
a file of its own, its key in SceneSettings, and a line in SOURCES.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from typing import Annotated, Any

from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, Strict, is_line, only, parsed_by, structure
from simmpp.scene.packed import kind_of
from simmpp.scene.scene import Scene
from simmpp.scene.spd.generators import known_names
from simmpp.workload.exchange.columns import is_workload
from simmpp.workload.particles.presets import PRESETS
from simmpp.workload.ray_source import NO_GEOMETRY, RaySource
from simmpp.workload.scene_settings import SceneSettings

CELLS = "expected a scene to trace; particles fly through cells, which have no surfaces"
A_SCENE = "a name such as mountain:5, a file or a mapping"


def long_scene(value: object) -> object:
    """The mapping that a text is short for: ``mountain:5``, ``bunny.glb:64``, ``own.nff`` ..."""
    if isinstance(value, os.PathLike):
        return _long_file(os.fspath(value))
    if not isinstance(value, str):
        return value
    name, colon, detail = value.rpartition(":")
    number = int(detail) if re.fullmatch("[0-9]{1,30}", detail) else None
    if value in known_names():
        return {"spd": value}
    if name in known_names():
        return {"spd": name, "size": detail if number is None else number}
    if value in PRESETS:
        return {"cells": {"preset": value}}
    if name in PRESETS:
        return {"cells": {"preset": name, "fineness": detail if number is None else number}}
    if number is not None:
        return {"mesh": name, "objects": {"clusters": number}}
    if detail in ("nodes", "components", "groups") and colon:
        return {"mesh": name, "objects": detail}
    return _long_file(value)


def _long_file(name: str) -> dict[str, object]:
    if is_workload(name):
        return {"workload": name}
    return {"nff" if kind_of(name) == "nff" else "mesh": name}


def _is_scene_or_text(value: object) -> bool:
    return is_line(value) or isinstance(value, Mapping | os.PathLike)


SceneKey = Annotated[
    SceneSettings, parsed_by(long_scene), only(_is_scene_or_text, Expect(A_SCENE))[0]
]
"""The last validator is asked first."""


class _Spec(Strict):
    """A mapping with the one key ``scene``, so that mistakes name it as in a configuration."""

    scene: SceneKey


def load_scene(spec: str | Mapping[str, object] | os.PathLike[str]) -> Scene:
    """The scene that ``spec`` names, as the key ``scene`` of a configuration does.

    A string is a generator with or without a size (``mountain:5``, ``tetra``) or a file: ``.nff``,
    or any mesh, the cut after a colon if wanted (``bunny.glb:components``, ``bunny.glb:64`` for
    clusters of at most 64 triangles). A mapping has the keys of a configuration:
    ``{spd: mountain, size: 5}``, ``{mesh: file.glb, objects: components, up: z}``,
    ``{nff: file.nff, camera: {eye: [0, 2, 6], angle: 30}, lights: [{position: [4, 5, 4]}]}``. A
    generated scene is its NFF text read back, so both ways in are one scene. Raises ConfigError for
    a spec that names nothing known and SceneError for a file that is no scene.
    """
    source = structure(_Spec, {"scene": _written(spec)}, {}).scene.source
    return scene_of(source, "scene")()


def _written(spec: Any) -> Any:
    """As a configuration would have it, where a path is a text."""
    if isinstance(spec, Mapping):
        return {key: _written(value) for key, value in spec.items()}
    if isinstance(spec, list | tuple):
        return [_written(value) for value in spec]
    return os.fspath(spec) if isinstance(spec, os.PathLike) else spec


def scene_of(source: RaySource, where: str) -> Callable[[], Scene]:
    """What makes the scene; ConfigError, naming ``where`` it was asked for, if there is none."""
    if source.scene is None:
        problem = CELLS if source.can_draw else NO_GEOMETRY
        raise ConfigError(problem, where=where)
    return source.scene


def require_drawn(source: RaySource, where: str) -> None:
    """Raise ConfigError, naming ``where`` it was asked for, for rays that nothing comes of."""
    if not source.can_draw:
        raise ConfigError(NO_GEOMETRY, where=where)
