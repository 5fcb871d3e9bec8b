"""Who owns an object, who else holds a replica of it, and who starts with which pixel."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    PlainSerializer,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.quantities import SHARE_OF_TEXT, Share, Size
from simmpp.common.strict import Expect, declared, integer, mistake, parsed_by
from simmpp.common.units import share, shown
from simmpp.common.validate import MOST_COUNT, require_whole, whole

# --- cutting a row of things into near-equal parts ---


def cut(n: int, parts: int) -> NDArray[np.int32]:
    """The part of each of n things in a row, cut at floor(i n / parts): (n,) int32."""
    cuts = np.arange(parts + 1, dtype=np.int64) * n // parts
    return np.repeat(np.arange(parts, dtype=np.int32), np.diff(cuts))


Owners = Literal["bisection", "morton", "round_robin", "random", "used"]
Residents = Literal["random", "nearest", "hot", "used"]
Pixels = Literal["blocks", "rows", "tiles", "interleaved", "random"]


@documented
@dataclass(frozen=True)
class Cells:
    """Pixels in squares, of that many along each side, which are dealt out in turn."""

    cells: int
    """Pixels along each side of a square."""

    def __post_init__(self) -> None:
        require_whole("cells", self.cells, 1, MOST_COUNT)


# --- what users write for pixels and for transient memory ---

_PIXELS = f"{', '.join(get_args(Pixels))} or {{cells: 8}}"
_CELLS_SCHEMA = {
    "type": "object",
    "properties": {"cells": {"type": "integer", "minimum": 1, "maximum": MOST_COUNT}},
    "required": ["cells"],
    "additionalProperties": False,
}
_PIXELS_SCHEMA = {"anyOf": [{"enum": list(get_args(Pixels))}, _CELLS_SCHEMA]}
AS_FRACTION: Literal["x"] = "x"
"""As many objects as are resident."""
_TRANSIENT = "a number of objects, a share of them such as 10% (100% at most), or x"
_COUNT = {"type": "integer", "minimum": 0, "maximum": MOST_COUNT}
_TRANSIENT_SCHEMA = {"anyOf": [_COUNT, SHARE_OF_TEXT, {"const": AS_FRACTION}]}


def _pixels(value: object) -> object:
    """One of the words, or ``{cells: 8}``."""
    if isinstance(value, dict) and set(value) == {"cells"}:
        return Cells(value["cells"])
    if isinstance(value, Cells) or (isinstance(value, str) and value in get_args(Pixels)):
        return value
    raise ConfigError(f"value {shown(value)}: expected {_PIXELS}")


def _transient(value: object) -> Fraction | int | str:
    """A share (a Fraction, or a text with % or /), a number of objects, or ``x``.

    1 is one object, and 0.1 nothing: what has neither % nor / is no share.
    """
    if isinstance(value, str) and value == AS_FRACTION:
        return AS_FRACTION
    try:
        if isinstance(value, Fraction) or (isinstance(value, str) and set("%/") & set(value)):
            return share(value)
        return whole(value, 0, MOST_COUNT)
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {_TRANSIENT}") from None


def _transient_text(value: Fraction | int | str) -> int | str:
    """As it would be written; 1/1 is everything, 1 one object."""
    return f"{value.numerator}/{value.denominator}" if isinstance(value, Fraction) else value


PixelRule = Annotated[Pixels | Cells, parsed_by(_pixels), Expect(_PIXELS, _PIXELS_SCHEMA)]
Transient = Annotated[
    Fraction | int | Literal["x"],
    parsed_by(_transient),
    Expect(_TRANSIENT, _TRANSIENT_SCHEMA, "objects or %"),
    PlainSerializer(_transient_text),
]


@declared
class Memory:
    """What fits into the memory of one PE."""

    fraction: Share = Fraction(1, 10)
    """Share x of all N objects that is resident on each PE: max(own, floor(x N + 1/2)) objects."""
    bytes: Size | None = None
    """The other way to say it: room for resident objects, in place of the fraction."""
    residents: Residents = "random"
    """Which objects are resident besides a PE's own: `hot`, most used in a coarse pre-pass; `used`,
    most used there by the PE's own pixels, for their size."""
    transient: Transient = 0
    """Fetched objects kept besides the resident ones (least recently used leaves): a number; a
    share of all N, rounded like the fraction's; `x`, the fraction's share (with bytes, as many as
    are resident in the mean). The replicated scene fetches none."""

    fetch: Size | None = None
    """The other way to say it: room for fetched objects, in place of a number of them."""
    hot: Share = Fraction(0)
    """Share of the objects, those most used for their size in a coarse pre-pass, that come first on
    every PE; they count as residents."""

    if TYPE_CHECKING:  # arguments take more than fields hold

        def __init__(
            self,
            fraction: Fraction | float | str = ...,
            bytes: int | str | None = ...,
            residents: Residents = ...,
            transient: Fraction | int | str = ...,
            fetch: int | str | None = ...,
            hot: Fraction | float | str = ...,
        ) -> None: ...

    @property
    def kept(self) -> Fraction | int | Literal["x"]:
        """The transient share or number of objects; ``x`` only where no fraction says which."""
        if self.fetch is not None:
            return 0
        by_fraction = self.transient == AS_FRACTION and self.bytes is None
        return self.fraction if by_fraction else self.transient

    @model_validator(mode="before")
    @classmethod
    def _one_size(cls, given: object) -> object:
        """Of what users write; Python's ``replace`` always passes both."""
        if isinstance(given, dict) and "fraction" in given and given.get("bytes") is not None:
            raise mistake("expected fraction or bytes, got both")
        if isinstance(given, dict) and "transient" in given and given.get("fetch") is not None:
            raise mistake("expected transient or fetch, got both")
        return given

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        plain: dict[str, Any] = handler(self)
        if self.bytes is not None:
            del plain["fraction"]
        if self.fetch is not None:
            del plain["transient"]
        if not self.hot:
            del plain["hot"]
        return plain


@declared
class PlacementRules:
    """How owners and pixels are chosen."""

    owners: Owners = "bisection"
    """How objects are dealt to their owners; `used`: to the PE whose pixels use them most in a
    coarse pre-pass."""
    pixels: PixelRule = "blocks"
    """How pixels are dealt to the PEs that start them. In turn: pixels (interleaved), rows, or
    squares of so many pixels along each side (cells)."""
    islands: Annotated[int, *integer(1, MOST_COUNT)] = 1
    """Equal parts of the machine, PEs in a row, that own the whole scene each and send one another
    nothing; pixels are dealt over all PEs. As many as PEs: the replicated scene."""

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        plain: dict[str, Any] = handler(self)
        if self.islands == 1:
            del plain["islands"]
        return plain


def island_of(rules: PlacementRules, processors: int) -> int:
    """PEs of an island.

    Raises ConfigError, whose place is the key, if the islands are not equal.
    """
    if processors % rules.islands:
        expected = f"expected a divisor of {processors}, the number of PEs"
        raise ConfigError(f"value {rules.islands}: {expected}", where="placement.islands")
    return processors // rules.islands


@documented
@dataclass(frozen=True, eq=False)
class Placement:
    """One draw of owners, residents and pixels for a number of PEs."""

    processors: int
    """Number of PEs, nb."""
    owners: NDArray[np.int32]
    """(N,) int32: the PE that owns each object; with islands of each, counted from its first PE."""
    replica_offsets: NDArray[np.int64]
    """(nb + 1,) int64: PE k holds replicas of
    replica_objects[replica_offsets[k]:replica_offsets[k + 1]] besides the objects it owns."""
    replica_objects: NDArray[np.int32]
    """(replicas,) int32 object ids."""
    transient: int
    """Number of fetched objects that a PE's transient memory holds."""
    pixel_pes: NDArray[np.int32]
    """(n0,) int32: the PE that each primary ray starts on."""
    transient_bytes: int = 0
    """Bytes of fetched objects that it holds, where a size says so; else 0."""
    islands: int = 1
    """Equal parts of the machine that own the whole scene each."""

    @property
    def island(self) -> int:
        """PEs of an island: PE k is in number k // island, at place k % island."""
        return self.processors // self.islands

    @property
    def effective_fraction(self) -> float:
        """Mean number of resident objects of a PE / number of objects (1 for an empty scene)."""
        n_objects = len(self.owners)
        if n_objects == 0:
            return 1.0
        n_owned = self.islands * n_objects
        return (n_owned + len(self.replica_objects)) / (self.processors * n_objects)
