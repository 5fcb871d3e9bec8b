"""What of a scene is to be traced: samples, depth, kinds of rays."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Any, Literal

from pydantic import model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, Switch, declared, integer, mistake, parsed_by
from simmpp.common.units import shown
from simmpp.common.validate import whole
from simmpp.scene.scene import Scene

MOST_PIXELS = 16384
"""Along each side."""
PATH, CORNERS = "path", "corners"
MOST_SAMPLES = 65536
"""Of each pixel."""
PATHS = 16
"""Of each pixel, when not given."""
OF_WHITTED, OF_PATHS = ("max_depth",), ("depth", "roulette")
"""Settings that only one way to render has."""
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


_COUNTED = f"a number per pixel from 1 to {MOST_SAMPLES}"
_SAMPLES = f"centres, corners, or {_COUNTED}"
_NUMBER = {"type": "integer", "minimum": 1, "maximum": MOST_SAMPLES}


def _samples(value: Any) -> Any:
    if isinstance(value, str) and value in ("centres", CORNERS):
        return value
    try:
        return whole(value, 1, MOST_SAMPLES)
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {_SAMPLES}") from None


Samples = Annotated[
    str | int,
    parsed_by(_samples),
    Expect(_SAMPLES, {"anyOf": [{"enum": ["centres", CORNERS]}, _NUMBER]}, "rays"),
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
    samples: Samples = "centres"
    """A ray per pixel centre, or per corner (the SPD's rules), or so many through points of each
    pixel that are drawn by chance. Paths are always drawn: 16 when no number is given."""
    max_depth: Annotated[int, *integer(1, 100)] = 5
    """Depth of the deepest ray that is not a shadow ray; the eye ray has depth 1."""
    shadows: Switch = True
    """Trace shadow rays."""
    reflection: Switch = True
    """Trace reflected rays."""
    refraction: Switch = True
    """Trace refracted rays."""
    render: Literal["whitted", "path"] = "whitted"
    """Whitted's rays: every mirrored and refracted one, and shadow rays to all lights; or paths,
    which go on from each hit with one ray drawn by chance, and one shadow ray."""
    depth: Annotated[int, *integer(1, 1000)] = 16
    """Of paths: depth of the deepest ray, shadow rays included; the eye ray has depth 1."""
    roulette: Annotated[int, *integer(1, 1001)] = 4
    """Of paths: depth from which chance may end one."""
    seed: Annotated[int, *integer(0, 2**32 - 1)] = 0
    """What chance is drawn from, with a number of samples or paths."""

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

    @model_validator(mode="after")
    def _goes_together(self) -> Picture:
        is_path = self.render == PATH
        if is_path and self.samples == CORNERS:
            raise mistake(f"samples: value {CORNERS!r}: expected {_COUNTED}, with render: path")
        if self.seed and not self.is_drawn:
            raise mistake("seed goes with a number of samples, or render: path")
        defaults = {field.name: field.default for field in dataclasses.fields(self)}
        for name in OF_WHITTED if is_path else OF_PATHS:
            if getattr(self, name) != defaults[name]:
                others = "; paths have depth" if is_path else ""
                raise mistake(f"{name} goes with render: {'whitted' if is_path else PATH}{others}")
        return self

    @property
    def passes(self) -> int:
        """Primary rays of each pixel, each in a pass of its own over the picture."""
        if isinstance(self.samples, int):
            return self.samples
        return PATHS if self.render == PATH else 1

    @property
    def is_drawn(self) -> bool:
        """Primary rays go through points that are drawn by chance."""
        return isinstance(self.samples, int) or self.render == PATH

    @property
    def n_roots(self) -> int:
        """Number of primary rays; ``of`` a scene."""
        rows, columns = self.shape
        return rows * columns * self.passes

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
        """Rows and columns of primary rays, in each pass."""
        rows, columns = self.pixels
        more = 1 if self.samples == CORNERS else 0
        return rows + more, columns + more
