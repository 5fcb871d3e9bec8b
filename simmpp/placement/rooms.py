"""How much of something fits on a PE, as users write it: kept objects, all memory, parts of it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Literal

from pydantic import InstanceOf, PlainSerializer

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.quantities import SHARE, SHARE_OF_TEXT, SIZE
from simmpp.common.strict import Expect, parsed_by
from simmpp.common.units import A_SHARE, MOST_BYTES, byte_count, share, shown, write_bytes
from simmpp.common.validate import MOST_COUNT, whole


@dataclass(frozen=True)
class Room:
    """Bytes, where a plain integer is a number of objects."""

    bytes: int


# --- resident objects ---

FILL: Literal["fill"] = "fill"
"""Replicas take what a capacity leaves."""
TO_FILL = f"value {FILL!r}: expected a capacity beside it"
_FRACTION = f"{A_SHARE}, or {FILL}"


def _fraction(value: object) -> Fraction | str:
    """A share, or ``fill``."""
    if value == FILL:
        return FILL
    try:
        return share(value)
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {_FRACTION}") from None


Part = Annotated[
    Fraction | Literal["fill"],
    parsed_by(_fraction),
    Expect(_FRACTION, {"anyOf": [*SHARE["anyOf"], {"const": FILL}]}, ""),
    PlainSerializer(str),
]

# --- fetched objects that are kept ---

AS_FRACTION: Literal["x"] = "x"
"""As many objects as are resident."""
_TRANSIENT = (
    "a number of objects, a share of them such as 10% (100% at most), x, or a size such as '64 kB'"
)
_COUNT = {"type": "integer", "minimum": 0, "maximum": MOST_COUNT}
_TRANSIENT_SCHEMA = {"anyOf": [_COUNT, SHARE_OF_TEXT, {"const": AS_FRACTION}, SIZE["anyOf"][0]]}


def _transient(value: object) -> Fraction | int | str | Room:
    """A share (a Fraction, or a text with % or /), a number of objects, ``x``, or bytes.

    1 is one object, and 0.1 nothing: what has neither % nor / is no share.
    """
    if isinstance(value, Room) or (isinstance(value, str) and value == AS_FRACTION):
        return value
    if isinstance(value, str):
        with suppress(ConfigError):
            return Room(byte_count(value))
    try:
        if isinstance(value, Fraction) or (isinstance(value, str) and set("%/") & set(value)):
            return share(value)
        return whole(value, 0, MOST_COUNT)
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {_TRANSIENT}") from None


def _text(value: Fraction | int | str | Room) -> int | str:
    """As it would be written; 1/1 is everything, 1 one object."""
    if isinstance(value, Room):
        return write_bytes(value.bytes)
    return f"{value.numerator}/{value.denominator}" if isinstance(value, Fraction) else value


Transient = Annotated[
    Fraction | int | Literal["x"] | InstanceOf[Room],
    parsed_by(_transient),
    Expect(_TRANSIENT, _TRANSIENT_SCHEMA, "objects, % or bytes"),
    PlainSerializer(_text),
]

# --- all memory of a PE ---

LEAST: Literal["least"] = "least"
"""The least with which a policy runs."""
Flow = Literal["credits", "none"]
Escape = Literal["fetch", "none"]
OF_A_CAPACITY = ("capacity", "flow", "escape", "buffers", "fetch")
"""Keys that mean nothing without one."""
_CAPACITY = "a size such as '64 MB', least or none"
_CAPACITY_SCHEMA = {"anyOf": [SIZE["anyOf"][0], {"enum": [LEAST, "none", None]}]}
_WISH = "a share such as 25%, or a size such as '1 MB'"
_WISH_SCHEMA = {"anyOf": [*SHARE["anyOf"], *SIZE["anyOf"]]}


def _capacity(value: object) -> object:
    """Bytes, ``least`` or None."""
    if value is None or value == "none":
        return None
    if value == LEAST:
        return value
    with suppress(ConfigError):
        bytes_ = byte_count(value) if isinstance(value, str) else whole(value, 1, MOST_BYTES)
        if bytes_ > 0:
            return bytes_
    raise ConfigError(f"value {shown(value)}: expected {_CAPACITY}")


def _wish(value: object) -> Fraction | Room:
    """A share, or bytes."""
    with suppress(ConfigError):
        return value if isinstance(value, Room) else Room(byte_count(value))
    try:
        return share(value)
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {_WISH}") from None


CapacityBytes = Annotated[
    int | Literal["least"] | None,
    parsed_by(_capacity),
    Expect(_CAPACITY, _CAPACITY_SCHEMA, "B, kB, MB, GB, TB, KiB, MiB, GiB or TiB"),
    PlainSerializer(lambda value: write_bytes(value) if isinstance(value, int) else value),
]
Wish = Annotated[
    Fraction | InstanceOf[Room],
    parsed_by(_wish),
    Expect(_WISH, _WISH_SCHEMA, "% or bytes"),
    PlainSerializer(_text),
]


@documented
@dataclass(frozen=True)
class Capacity:
    """All memory of one PE."""

    bytes: int | Literal["least"]
    """How much it is, or the least with which a policy runs."""
    flow: Flow = "credits"
    """``none``: it is only compared with what is held."""
    escape: Escape = "fetch"
    """What a PE does that can't go on; ``none``: it waits."""
    buffers: Fraction | Room = Fraction(1, 4)
    """Room for rays that arrive: a share of what permanent parts leave, or bytes."""
    fetch: Fraction | Room = Fraction(1, 4)
    """Likewise for objects that are fetched."""

    @property
    def has_credits(self) -> bool:
        """A PE sends rays only where there is room for them."""
        return self.flow == "credits"

    @property
    def has_escape(self) -> bool:
        """A PE that can't go on fetches an object."""
        return self.has_credits and self.escape == "fetch"
