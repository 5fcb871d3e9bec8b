"""How users say who starts with which pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, get_args

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, parsed_by
from simmpp.common.units import shown
from simmpp.common.validate import MOST_COUNT, require_whole

Pixels = Literal["blocks", "rows", "tiles", "interleaved", "random", "home", "home_spread"]
OF_HOMES = ("home", "home_spread")
"""Of these, those that need rays with homes."""


@documented
@dataclass(frozen=True)
class Cells:
    """Pixels in squares, of that many along each side, which are dealt out in turn."""

    cells: int
    """Pixels along each side of a square."""

    def __post_init__(self) -> None:
        require_whole("cells", self.cells, 1, MOST_COUNT)


_PIXELS = f"{', '.join(get_args(Pixels))} or {{cells: 8}}"
_CELLS_SCHEMA = {
    "type": "object",
    "properties": {"cells": {"type": "integer", "minimum": 1, "maximum": MOST_COUNT}},
    "required": ["cells"],
    "additionalProperties": False,
}
_PIXELS_SCHEMA = {"anyOf": [{"enum": list(get_args(Pixels))}, _CELLS_SCHEMA]}


def _pixels(value: object) -> object:
    """One of the words, or ``{cells: 8}``."""
    if isinstance(value, dict) and set(value) == {"cells"}:
        return Cells(value["cells"])
    if isinstance(value, Cells) or (isinstance(value, str) and value in get_args(Pixels)):
        return value
    raise ConfigError(f"value {shown(value)}: expected {_PIXELS}")


PixelRule = Annotated[Pixels | Cells, parsed_by(_pixels), Expect(_PIXELS, _PIXELS_SCHEMA)]
