"""The key ``scene``: what is rendered, and the short forms of it."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import Field, ValidationInfo, field_validator, model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, Strict, Text, mistake, one_of, parsed_by
from simmpp.config import values
from simmpp.scene.spd.generators import find_generator, known_names
from simmpp.workload.exchange.exchange import is_workload

SOURCES = ("spd", "nff", "mesh", "workload")
"""Keys of which one says what is rendered."""
FILES = SOURCES[1:]
"""Those that name a file."""

_CLUSTERS = {
    "type": "object",
    "properties": {"clusters": {"type": "integer", "minimum": 1}},
    "required": ["clusters"],
    "additionalProperties": False,
}
_OBJECTS = Expect(values.OBJECTS, {"anyOf": [{"enum": ["nodes", "components"]}, _CLUSTERS]})
Objects = Annotated[str | dict[str, int], parsed_by(values.objects), _OBJECTS]


class SceneSettings(Strict):
    """What is rendered: one of SOURCES. Text such as ``mountain:5`` is short for it."""

    spd: Annotated[str, *one_of(*known_names())] | None = Field(
        default=None, description="a scene of the Standard Procedural Databases (Haines 1987)"
    )
    size: Annotated[int, parsed_by(values.size), Expect(values.SIZE)] | None = Field(
        default=None, description="size of that scene; the SPD's own when not given"
    )
    nff: Text | None = Field(
        default=None, description="an NFF file, relative to the configuration's folder"
    )
    mesh: Text | None = Field(
        default=None, description="a mesh file that trimesh reads (OBJ, PLY, STL, GLB ...)"
    )
    objects: Objects | None = Field(
        default=None, description="how a mesh is cut into objects; components when not given"
    )

    workload: Text | None = Field(
        default=None, description="rays of another renderer, in Parquet or npz, in place of a scene"
    )

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
        elif self.size is not None and given != ["spd"]:
            problem = "size goes with spd only"
        elif self.objects is not None and given != ["mesh"]:
            problem = "objects goes with mesh only"
        else:
            return self
        raise mistake(problem)


def long_scene(value: object) -> object:
    """``mountain:5`` or a file's name as the mapping it is short for."""
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
    if is_workload(value):
        return {"workload": value}
    return {"nff" if value.lower().endswith(".nff") else "mesh": value}
