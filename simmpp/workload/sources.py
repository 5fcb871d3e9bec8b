"""The key ``scene`` with its short forms, and a line for each kind of source that it names.

Every door takes the same and says the same of a mistake: a configuration, ``simmpp scene SPEC``,
``simmpp workload SPEC``, ``simmpp.load_scene(spec)``. A further kind of workload is a RaySource in
a file of its own, its key in SceneSettings, and a line in SOURCES.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from pydantic import ValidationInfo, field_validator, model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.strict import (
    Expect,
    Strict,
    Text,
    is_line,
    mistake,
    one_of,
    only,
    parsed_by,
    structure,
)
from simmpp.scene.cut import OBJECTS, cut_named
from simmpp.scene.mesh import load_mesh
from simmpp.scene.nff import load_nff
from simmpp.scene.packed import kind_of
from simmpp.scene.scene import Scene
from simmpp.scene.spd.generators import GENERATORS, find_generator, known_names, load_spd
from simmpp.workload.exchange.columns import is_workload
from simmpp.workload.ray_source import FileSource, RaySource, SceneSource

SIZE = "an integer from 1 to what the scene can have"
A_SCENE = "a name such as mountain:5, a file or a mapping"


def _load_mesh(file: str, objects: Any = "components") -> Scene:
    """The scene of a mesh file, or what else its name may have meant."""
    # os.path answers no where pathlib raises, as for a name that no file can have.
    if not os.path.exists(file):
        name, (mesh, _, cut) = Path(file).name, file.rpartition(":")
        if os.path.exists(mesh):
            raise ConfigError(f"value {cut!r}: expected {OBJECTS}", where=file)
        if name.lower() in known_names():
            raise ConfigError(f"no scene {name!r}: expected {name.lower()!r}")
        if not Path(file).suffix:
            problem = f"no such file, and the generated scenes are {', '.join(GENERATORS)}"
            raise ConfigError(f"no scene {file!r}: {problem}")
    return load_mesh(file, objects=objects)


def _traced(load: Callable[..., Scene]) -> Callable[..., RaySource]:
    return lambda *values: SceneSource(partial(load, *values))


@dataclass(frozen=True)
class Kind:
    """A key under ``scene`` of which exactly one is given."""

    source: Callable[..., RaySource]
    """Takes the value of the key, then those of the further keys that are given."""
    further: tuple[str, ...] = ()
    """Keys that go with this one only."""
    is_file: bool = True
    """The value is a file's name."""


SOURCES = {
    "spd": Kind(_traced(load_spd), ("size",), is_file=False),
    "nff": Kind(_traced(load_nff)),
    "mesh": Kind(_traced(_load_mesh), ("objects",)),
    "workload": Kind(FileSource),
}
FILES = [key for key, kind in SOURCES.items() if kind.is_file]


def _is_size(value: object) -> bool:
    """Could some scene have it? The scene's generator knows the largest."""
    return isinstance(value, int) and not isinstance(value, bool) and 1 <= value < 10**30


def _objects(value: Any) -> Any:
    cut_named(value)
    return value


_CLUSTERS = {
    "type": "object",
    "properties": {"clusters": {"type": "integer", "minimum": 1}},
    "required": ["clusters"],
    "additionalProperties": False,
}
_OBJECTS = Expect(OBJECTS, {"anyOf": [{"enum": ["nodes", "components"]}, _CLUSTERS]})
Objects = Annotated[str | dict[str, int], parsed_by(_objects), _OBJECTS]


class SceneSettings(Strict):
    """What is rendered: one of SOURCES. Text such as ``mountain:5`` is short for it."""

    spd: Annotated[str, *one_of(*known_names())] | None = None
    """A scene of the Standard Procedural Databases (Haines 1987)."""
    size: Annotated[int, *only(_is_size, Expect(SIZE))] | None = None
    """Size of that scene; the SPD's own when not given."""
    nff: Text | None = None
    """An NFF file, relative to the configuration's folder."""
    mesh: Text | None = None
    """A mesh file: GLB, glTF, OBJ, PLY, STL or OFF, or one of these packed by gzip."""
    objects: Objects | None = None
    """How a mesh is cut into objects; components when not given."""
    workload: Text | None = None
    """Rays of another renderer, in Parquet or npz, in place of a scene."""

    @field_validator("size")
    @classmethod
    def _size_exists(cls, size: int | None, others: ValidationInfo) -> int | None:
        name = others.data.get("spd")
        if size is not None and name is not None:
            try:
                find_generator(name).check(size)
            except ConfigError as error:
                raise mistake(f"value {size}: {error.problem}") from None
        return size

    @model_validator(mode="after")
    def _one_source(self) -> SceneSettings:
        given = [key for key in SOURCES if getattr(self, key) is not None]
        if len(given) != 1:
            problem = f"expected one of {', '.join(SOURCES)}, got {' and '.join(given) or 'none'}"
            raise mistake(problem)
        for key, kind in SOURCES.items():
            for further in kind.further:
                if key != given[0] and getattr(self, further) is not None:
                    raise mistake(f"{further} goes with {key} only")
        return self

    def within(self, folder: Path) -> SceneSettings:
        """The same, with a file's name that is relative to ``folder`` made to hold from here."""
        files = {key: getattr(self, key) for key in FILES}
        return self.model_copy(
            update={key: str(folder / name) for key, name in files.items() if name is not None}
        )

    @property
    def source(self) -> RaySource:
        """Where the rays come from; file names are taken from the present folder."""
        key = next(key for key in SOURCES if getattr(self, key) is not None)
        kind = SOURCES[key]
        values = (getattr(self, name) for name in (key, *kind.further))
        return kind.source(*(value for value in values if value is not None))


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
    if number is not None:
        return {"mesh": name, "objects": {"clusters": number}}
    if detail in ("nodes", "components") and colon:
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
    clusters of at most 64 triangles). A mapping is ``{spd: mountain, size: 5}``,
    ``{nff: file.nff}`` or ``{mesh: file.glb, objects: components}``. A generated scene is its NFF
    text read back, so both ways in are one scene. Raises ConfigError for a spec that names
    nothing known and SceneError for a file that is no scene.
    """
    if isinstance(spec, Mapping):
        spec = {key: os.fspath(v) if isinstance(v, os.PathLike) else v for key, v in spec.items()}
    source = structure(_Spec, {"scene": spec}, {}).scene.source
    return scene_of(source, "scene")()


def scene_of(source: RaySource, where: str) -> Callable[[], Scene]:
    """What makes the scene; ConfigError, naming ``where`` it was asked for, if there is none."""
    if source.scene is None:
        problem = "expected a scene to trace; a workload file has rays, but no geometry"
        raise ConfigError(problem, where=where)
    return source.scene
