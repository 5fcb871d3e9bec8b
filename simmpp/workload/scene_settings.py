"""The key ``scene``: the kinds of scenes, what each is loaded by, and what is set over it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from pydantic import ValidationInfo, field_validator, model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, Strict, Text, mistake, one_of, only, parsed_by
from simmpp.scene.cut import OBJECTS, cut_named
from simmpp.scene.mesh import load_mesh, load_parts
from simmpp.scene.nff import load_nff
from simmpp.scene.parts import Parts
from simmpp.scene.scene import Scene, Vector
from simmpp.scene.spd.generators import GENERATORS, find_generator, known_names, load_spd
from simmpp.scene.view import AXES, CameraKey, Lights, View, three, viewed
from simmpp.workload.particles.cells import CellsKey
from simmpp.workload.particles.settings import Particles
from simmpp.workload.particles.source import ParticleSource
from simmpp.workload.ray_source import FileSource, RaySource, SceneSource

SIZE = "an integer from 1 to what the scene can have"


def _load_mesh(file: str, **how: Any) -> Scene:
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
    return load_mesh(file, **how)


@dataclass(frozen=True)
class Kind:
    """A key under ``scene`` of which exactly one is given."""

    load: Callable[..., Scene] | None = None
    """Takes the value of the key, and those of the further keys that are given by name."""
    further: tuple[str, ...] = ()
    """Keys that the loader reads."""
    is_file: bool = True
    """The value is a file's name."""
    asks: tuple[str, ...] = ("picture", "radiosity")
    """Keys of a configuration that say what its rays are for."""


SOURCES = {
    "spd": Kind(load_spd, ("size",), is_file=False),
    "nff": Kind(load_nff),
    "mesh": Kind(_load_mesh, ("objects", "up")),
    "parts": Kind(load_parts, ("objects", "up"), is_file=False),
    "cells": Kind(is_file=False, asks=("particles",)),
    "workload": Kind(asks=()),
}
VIEW = ("camera", "lights", "up", "background")
"""Keys that go with all that is traced."""
FILES = [key for key, kind in SOURCES.items() if kind.is_file]


def _is_size(value: object) -> bool:
    """Could some scene have it? The scene's generator knows the largest."""
    return isinstance(value, int) and not isinstance(value, bool) and 1 <= value < 10**30


def _viewed(load: Callable[[], Scene], view: View) -> Scene:
    return viewed(load(), view)


def _objects(value: Any) -> Any:
    cut_named(value)
    return value


_CLUSTERS = {
    "type": "object",
    "properties": {"clusters": {"type": "integer", "minimum": 1}},
    "required": ["clusters"],
    "additionalProperties": False,
}
_OBJECTS = Expect(OBJECTS, {"anyOf": [{"enum": ["nodes", "components", "groups"]}, _CLUSTERS]})
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
    parts: Parts | None = None
    """Several mesh files in one scene, each in its place."""
    objects: Objects | None = None
    """How meshes are cut into objects; components when not given. Groups are OBJ's `g`."""
    camera: CameraKey | None = None
    """From where it is seen; when not given, by the file's camera if it has one, else one that
    shows everything."""
    lights: Lights | None = None
    """Point lights in place of the file's, or of two around all of it where it has none."""
    up: Annotated[str, *one_of(*AXES)] | None = None
    """The axis that is upwards in the picture; when not given, y in meshes (z in STL) and the
    camera's own where the file has one."""
    background: Annotated[Vector, *three("[0, 0, 0]", 0.0)] | None = None
    """Red, green and blue of what rays meet that hit nothing; traced paths are lit by it."""
    cells: CellsKey | None = None
    """Cells that particles fly through, in place of a scene: a preset, or one's own."""
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
        self._refuse_others(given[0], SOURCES[given[0]])
        return self

    def _refuse_others(self, given: str, kind: Kind) -> None:
        """Raise for keys that the kind of scene has no use for."""
        further = dict.fromkeys(key for other in SOURCES.values() for key in other.further)
        for key in (*further, *VIEW):
            if getattr(self, key) is None or key in kind.further:
                continue
            if key not in VIEW:
                takers = [name for name, other in SOURCES.items() if key in other.further]
                raise mistake(f"{key} goes with {' or '.join(takers)} only")
            if kind.load is None:
                raise mistake(f"{key} goes with a scene that is traced, not with {given}")

    def within(self, folder: Path) -> SceneSettings:
        """The same, with a file's name that is relative to ``folder`` made to hold from here."""
        files = {key: getattr(self, key) for key in FILES}
        changed: dict[str, Any] = {
            key: str(folder / name) for key, name in files.items() if name is not None
        }
        if self.parts is not None:
            changed["parts"] = tuple(
                part.model_copy(update={"mesh": str(folder / part.mesh)}) for part in self.parts
            )
        return self.model_copy(update=changed)

    @property
    def kind(self) -> tuple[str, tuple[str, ...]]:
        """The key that is given, and the keys that say what its rays are for."""
        key = next(key for key in SOURCES if getattr(self, key) is not None)
        return key, SOURCES[key].asks

    @property
    def source(self) -> RaySource:
        """Where the rays come from; file names are taken from the present folder."""
        key, _ = self.kind
        kind = SOURCES[key]
        value, load = getattr(self, key), kind.load
        if self.cells is not None:
            return ParticleSource(self.cells, Particles())
        if load is None:
            return FileSource(value)
        further = {name: getattr(self, name) for name in kind.further}
        load = partial(load, value, **{k: v for k, v in further.items() if v is not None})
        view = View(self.camera, self.lights, self.up, self.background)
        return SceneSource(load if view == View() else partial(_viewed, load, view))
