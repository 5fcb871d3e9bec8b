"""The key ``radiosity``: what is reckoned of the light between patches, in place of a picture."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.quantities import SHARE_OF_TEXT
from simmpp.common.strict import Expect, declared, integer, mistake, parsed_by
from simmpp.common.units import share, shown
from simmpp.workload.picture import Resolution

GATHERING, SHOOTING = "gathering", "shooting"
LEAST_RAYS = 16
"""Of the smallest patch."""
_RESIDUAL = "a share above 0% and below 100%, such as 1%"
_PATCHES = "a share of all surface above 0%, such as 0.1%, or an area above 0 in the scene's units"
_OPEN = {"type": "number", "exclusiveMinimum": 0}


def _residual(value: object) -> Fraction:
    try:
        residual = share(value)
    except ConfigError:
        residual = Fraction(0)
    if not 0 < residual < 1:
        raise ConfigError(f"value {shown(value)}: expected {_RESIDUAL}")
    return residual


def _patches(value: Any) -> Any:
    is_area = isinstance(value, int | float) and not isinstance(value, bool)
    try:
        area = float(value) if is_area else share(value)
    except (ConfigError, OverflowError):
        area = 0.0
    if not 0 < area < float("inf"):
        raise ConfigError(f"value {shown(value)}: expected {_PATCHES}")
    return area


Residual = Annotated[
    Fraction,
    parsed_by(_residual),
    Expect(_RESIDUAL, {"anyOf": [{**_OPEN, "exclusiveMaximum": 1}, SHARE_OF_TEXT]}),
]
PatchArea = Annotated[
    Fraction | float,
    parsed_by(_patches),
    Expect(_PATCHES, {"anyOf": [_OPEN, SHARE_OF_TEXT]}),
]


@declared
class Radiosity:
    """Radiosity of matt patches, in place of a picture.

    Triangles and quadrilaterals of the scene are halved across their longest sides until none is
    larger than ``patches``; they shine and are lit on their front, which their corners go round
    counter-clockwise.
    """

    method: Literal["gathering", "shooting"] = "gathering"
    """Form factors of all patches, of which a system of equations is solved; or progressive: the
    patch with most unshot power shoots, then the next one, each step a round."""
    rays: Annotated[int, *integer(1, 2**20, "rays")] = 256
    """Of a patch of mean area, others in proportion, at least 16; or of each shot."""
    patches: PatchArea = Fraction(1, 1000)
    """Area of the largest patch: a share of all surface, or a number in the scene's units."""
    residual: Residual = Fraction(1, 100)
    """Of shooting: share of the emitted power that may be unshot at the end."""
    seed: Annotated[int, *integer(0, 2**32 - 1)] = 0
    """What the points and directions of each patch are shifted by."""
    resolution: Resolution = 512
    """Of the picture that shows the patches: pixels along each side, or across and down; `own`
    takes what the scene asks for."""

    @model_validator(mode="after")
    def _goes_together(self) -> Radiosity:
        if self.method != SHOOTING and self.residual != type(self).residual:
            raise mistake(f"residual goes with method: {SHOOTING}")
        return self
