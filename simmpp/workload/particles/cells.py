"""The key ``scene.cells``: a box cut into equal cells, what they are made of, what emits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.strict import (
    Expect,
    Short,
    Strict,
    in_words,
    integer,
    is_line,
    mistake,
    one_of,
    only,
    parsed_by,
)
from simmpp.common.units import shown
from simmpp.common.validate import whole
from simmpp.scene.scene import Vector
from simmpp.scene.view import is_number, listed, three
from simmpp.workload.particles.presets import PRESETS

SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")
"""In the order of their numbers."""
MOST_CELLS = 2**26
"""Each takes about 100 B of memory while particles are followed."""
MOST_MATERIALS = 255
MOST_IMPORTANCE = 2**20
GROUP_BYTES = 80
"""Cross sections of a group: ten float64. ESTIMATE"""
STATE_BYTES = 176
"""Corners, neighbours, sides and temperatures: Branson's class Cell (branson_dd/src/cell.h)."""
_BOXES = "a list such as [{material: wall, low: [0, 0, 0], high: [1, 1, 1]}]"


def _number(is_right: Callable[[float], bool], expected: str) -> tuple[Any, Expect]:
    """Marks of a number that is right."""

    def parse(value: Any) -> float:
        if not is_number(value) or not is_right(value):
            raise ConfigError(f"value {shown(value)}: expected {expected}")
        return float(value)

    return parsed_by(parse), Expect(expected, {"type": "number"})


def _grid(value: Any) -> tuple[int, int, int]:
    cells = value if isinstance(value, list | tuple) else ()
    if len(cells) != 3:
        raise ConfigError(f"value {shown(value)}: expected {_GRID}")
    x, y, z = (whole(number, 1, MOST_CELLS) for number in cells)
    return x, y, z


_GRID = "three numbers of cells, along x, y and z, such as [8, 8, 16]"
_SIDE = {"type": "integer", "minimum": 1, "maximum": MOST_CELLS}
_GRID_SCHEMA = {"type": "array", "items": _SIDE, "minItems": 3, "maxItems": 3}


def _are_sides(value: object) -> bool:
    return isinstance(value, list | tuple) and all(side in SIDES for side in value)


_MIRRORS = f"a list of sides, such as [-x, -y]: {', '.join(SIDES)}"
_SIDES = {"type": "array", "items": {"enum": list(SIDES)}}


class Material(Strict):
    """What a particle meets in cells; one group."""

    sigma_t: Annotated[float, *_number(lambda x: x >= 0, "a number from 0, per unit of length")]
    """Total cross section: collisions per unit of length."""
    albedo: Annotated[float, *_number(lambda x: 0 <= x <= 1, "a share from 0 to 1")] = 0.0
    """Share of the collisions that scatter; the others absorb."""
    g: Annotated[float, *_number(lambda x: -1 < x < 1, "a number above -1 and below 1")] = 0.0
    """Mean cosine of the angle of scattering (Henyey and Greenstein 1941); 0: isotropic."""


class Box(Strict):
    """Cells whose centres lie in a box; of several boxes the last one counts."""

    material: Annotated[str, *only(is_line, Expect("the name of a material"))]
    """What they are made of."""
    low: Annotated[Vector, *three("[0, 0, 0]")]
    """The corner of the least coordinates."""
    high: Annotated[Vector, *three("[1, 1, 1]")]
    """The corner of the greatest coordinates."""
    importance: Annotated[int, *integer(1, MOST_IMPORTANCE)] = 1
    """With `particles.splitting`: a particle that comes in from cells of half the importance is
    split in two; out, one of two goes on. A power of two."""

    @model_validator(mode="after")
    def _is_power(self) -> Box:
        if self.importance & (self.importance - 1):
            raise mistake(f"importance: value {self.importance}: expected a power of two")
        return self


class Emitter(Strict):
    """Where particles begin: evenly in a box, on a rectangle, or at a point."""

    low: Annotated[Vector, *three("[0, 0, 0]")]
    """The corner of the least coordinates."""
    high: Annotated[Vector, *three("[1, 1, 1]")] | None = None
    """The corner of the greatest coordinates; that of `low` when not given, which is a point."""
    emits: Literal["isotropic", "cosine", "beam"] = "isotropic"
    """To all sides alike; by Lambert's cosine about `towards`; or along it."""
    towards: Annotated[Vector, *three("[0, 0, 1]")] = (0.0, 0.0, 1.0)
    """The direction of a cosine's axis or of a beam."""

    @model_validator(mode="after")
    def _has_a_direction(self) -> Emitter:
        if not any(self.towards):
            raise mistake("towards is [0, 0, 0]: expected a direction")
        return self


class Cells(Strict):
    """A box from [0, 0, 0], cut into equal cells; those that none of `boxes` covers are empty."""

    preset: Annotated[str, *one_of(*PRESETS)] | None = None
    """One of the field's test problems; keys beside it take the place of its own."""
    fineness: Annotated[int, *integer(1, 64)] = 1
    """Cells along each side are so many times what `grid` says."""
    grid: Annotated[tuple[int, int, int], parsed_by(_grid), Expect(_GRID, _GRID_SCHEMA)]
    """Cells along x, y and z; each is an object."""
    size: Annotated[Vector, *three("[1, 1, 1]")]
    """Lengths along x, y and z, in the unit that sigma_t is per."""
    materials: dict[str, Material] = Field(default={})
    """Cross sections, by a name for each material; those of a preset can be changed one by one."""
    boxes: Annotated[tuple[Box, ...], *listed(_BOXES, 1)]
    """Which cells are made of what."""
    mirrors: Annotated[tuple[str, ...], *only(_are_sides, Expect(_MIRRORS, _SIDES))] = ()
    """Sides that reflect particles; through the others they leave."""
    source: Emitter
    """Where particles begin."""
    groups: Annotated[int, *integer(1, 10_000, "groups")] = 1
    """Of energy, as far as a cell's bytes go; particles have one."""

    @model_validator(mode="after")
    def _goes_together(self) -> Cells:
        for problem in _problems(self):
            raise mistake(problem)
        return self

    @property
    def shape(self) -> tuple[int, int, int]:
        """Cells along x, y and z."""
        x, y, z = self.grid
        return x * self.fineness, y * self.fineness, z * self.fineness

    @property
    def name(self) -> str:
        """What rows call it."""
        name = self.preset or "cells"
        return name if self.fineness == 1 else f"{name}:{self.fineness}"


def _problems(cells: Cells) -> Iterator[str]:
    """What does not go together."""
    x, y, z = cells.shape
    if x * y * z > MOST_CELLS:
        yield f"{x} x {y} x {z} cells: expected at most {MOST_CELLS}"
    if not min(cells.size) > 0:
        yield f"size: value {list(cells.size)}: expected lengths above 0"
    if len(cells.materials) > MOST_MATERIALS:
        yield f"materials: {len(cells.materials)} of them: expected at most {MOST_MATERIALS}"
    names = [box.material for box in cells.boxes]
    for name in names:
        if name not in cells.materials:
            known = in_words(tuple(cells.materials)) or "a key materials"
            yield f"boxes: no material {name!r}: expected {known}"
    low, high = cells.source.low, cells.source.high or cells.source.low
    if not all(0 <= a <= b <= side for a, b, side in zip(low, high, cells.size, strict=True)):
        inside = f"expected it inside of the cells, [0, 0, 0] to {list(cells.size)}"
        yield f"source: value {list(low)} to {list(high)}: {inside}"
    of_boxes = [cells.materials[name] for name in names]
    absorbs = any(material.sigma_t > 0 and material.albedo < 1 for material in of_boxes)
    if set(SIDES) <= set(cells.mirrors) and not absorbs:
        yield "mirrors: all sides, and nothing absorbs: expected a way for particles to end"


def named_cells(value: object) -> object:
    """The mapping that a preset's name is short for."""
    return {"preset": value} if isinstance(value, str) else value


def long_cells(value: object) -> object:
    """All keys of a preset, some of them changed."""
    given = named_cells(value)
    if not isinstance(given, dict) or given.get("preset") not in tuple(PRESETS):
        return given
    keys, materials = PRESETS[given["preset"]], given.get("materials", {})
    if isinstance(materials, dict):
        changed = {
            name: _changed(keys["materials"].get(name, {}), materials[name]) for name in materials
        }
        given = given | {"materials": keys["materials"] | changed}
    return keys | given


def _changed(keys: dict[str, object], given: object) -> object:
    """Keys of a material, some of them given."""
    return keys | given if isinstance(given, dict) else given


_NAMES = {"type": "string", "enum": list(PRESETS)}
CellsKey = Annotated[
    Cells, parsed_by(long_cells), Short(f"a preset: {in_words(tuple(PRESETS))}", _NAMES)
]
