"""What of a scene is to be traced: samples, depth, kinds of rays."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Any, Literal

from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, Switch, declared, integer, parsed_by
from simmpp.common.units import shown
from simmpp.common.validate import whole
from simmpp.scene.scene import Scene

MOST_PIXELS = 16384
"""Along each side."""
OWN = "own"
"""The resolution that the scene itself asks for."""
_RESOLUTION = f"an integer from 1 to {MOST_PIXELS}, [width, height], or {OWN}"
_SIDE = {"type": "integer", "minimum": 1, "maximum": MOST_PIXELS}
_SIDES = {"type": "array", "items": _SIDE, "minItems": 2, "maxItems": 2}


def _resolution(value: Any) -> Any:
    if value == OWN:
        return value
    pair = isinstance(value, list | tuple) and len(value) == 2
    try:
        sides = [whole(side, 1, MOST_PIXELS) for side in (value if pair else [value])]
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {_RESOLUTION}") from None
    return tuple(sides) if pair else sides[0]


Resolution = Annotated[
    int | tuple[int, int] | Literal["own"],
    parsed_by(_resolution),
    Expect(_RESOLUTION, {"anyOf": [_SIDE, _SIDES, {"enum": [OWN]}]}, "pixels"),
]


@declared
class Picture:
    """Settings of one picture.

    ``centres`` takes one primary ray through each pixel centre, ``corners`` one through each of the
    (width + 1) x (height + 1) pixel corners, as the SPD's testing procedures ask. Pixels are
    squares; the upper and lower edge of the picture lie at +-tan(angle / 2).
    """

    resolution: Resolution = 512
    """Pixels along each side of a square, or across and down; `own` takes what the scene asks for:
    NFF's line `resolution`, without one 512 x 512."""
    samples: Literal["centres", "corners"] = "centres"
    """A ray per pixel centre, or per corner (the SPD's rules)."""
    max_depth: Annotated[int, *integer(1, 100)] = 5
    """Depth of the deepest ray that is not a shadow ray; the eye ray has depth 1."""
    shadows: Switch = True
    """Trace shadow rays."""
    reflection: Switch = True
    """Trace reflected rays."""
    refraction: Switch = True
    """Trace refracted rays."""

    def of(self, scene: Scene) -> Picture:
        """The same with a resolution in numbers: ``own`` is the scene's.

        Raises ConfigError for a scene that asks for more than MOST_PIXELS.
        """
        if self.resolution != OWN:
            return self
        try:
            return dataclasses.replace(self, resolution=scene.camera.resolution)
        except ConfigError as error:
            raise ConfigError(error.problem, where=scene.name) from None

    @property
    def pixels(self) -> tuple[int, int]:
        """Rows and columns of pixels; ``of`` a scene."""
        if isinstance(self.resolution, tuple):
            columns, rows = self.resolution
            return rows, columns
        if isinstance(self.resolution, int):
            return self.resolution, self.resolution
        raise ValueError("expected the picture of a scene: its resolution is the scene's own")

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of primary rays."""
        rows, columns = self.pixels
        more = 1 if self.samples == "corners" else 0
        return rows + more, columns + more
