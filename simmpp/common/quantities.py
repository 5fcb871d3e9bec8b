"""Settings that are quantities: users write text with a unit, Python may pass exact integers.

What is computed with is the integer (ps, bytes, bytes per second); files get the text again.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainSerializer

from simmpp.common import units
from simmpp.common.strict import Expect, parsed_by
from simmpp.common.units import NUMBER
from simmpp.common.validate import whole

_PREFIX = "(?:[pnuµμmkMGT]|[KMGT]i|pico|nano|micro|milli|kilo|mega|giga|tera|kibi|mebi|gibi|tebi)?"
_SECONDS, _BYTES = rf"{_PREFIX}(?:s|min|seconds?|minutes?)", rf"{_PREFIX}(?:B|bytes?)"
_BYTES_OR_BITS = rf"{_PREFIX}(?:B|bytes?|b|bits?)"


def _text(unit: str) -> dict[str, str]:
    return {"type": "string", "pattern": rf"^\s*{NUMBER}\s*{unit}\s*$"}


TIME = {"anyOf": [_text(_SECONDS), {"const": 0}]}
"""JSON schemas of what users write."""
SIZE = {"anyOf": [_text(_BYTES), {"const": 0}]}
BANDWIDTH = {"anyOf": [_text(f"{_BYTES_OR_BITS}/{_SECONDS}"), {"const": "unlimited"}]}
POWER = {"anyOf": [_text("[mkM]?W"), {"const": 0}]}
PRICE = _text(r"/\s*h")
SHARE_TEXT = _text(r"(?:%|/\s*[0-9]{1,18})?")
SHARE_OF_TEXT = _text(r"(?:%|/\s*[0-9]{1,18})")
"""A share that can't be taken for a number."""
SHARE = {"anyOf": [{"type": "number", "minimum": 0, "maximum": 1}, SHARE_TEXT]}


def _up_to(most: int) -> Callable[[object], int]:
    """A quantity that Python passes as a number."""
    return lambda value: whole(value, 0, most)


def _marks(
    written: Callable[[object], Any], passed: Callable[[object], Any] | None, expected: Expect
) -> tuple[BeforeValidator, Expect, PlainSerializer]:
    return parsed_by(written, passed), expected, PlainSerializer(expected.write)


_A_TIME = Expect(
    units.A_TIME,
    TIME,
    "ps, ns, us, ms, s or min",
    f"0 to {units.format_ps(units.LONGEST_PS)}",
    units.write_ps,
    "an integer of picoseconds",
)
_A_MOMENT = Expect(
    units.A_TIME,
    TIME,
    "ps, ns, us, ms, s or min",
    f"0 to {units.LATEST_PS // 10**12} s",
    units.write_ps,
    "an integer of picoseconds",
)
_A_SIZE = Expect(
    units.A_SIZE,
    SIZE,
    "B, kB, MB, GB, TB, KiB, MiB, GiB or TiB",
    f"0 to {units.format_bytes(units.MOST_BYTES)}",
    units.write_bytes,
    "an integer of bytes",
)
_A_BANDWIDTH = Expect(
    units.A_BANDWIDTH,
    BANDWIDTH,
    "B/s, kB/s, MB/s, GB/s or TB/s; in bits, 8 to a byte: bit/s, kbit/s, Mbit/s, Gbit/s or Tbit/s",
    " to ".join(map(units.format_bytes_per_s, (units.LEAST_BYTES_PER_S, units.MOST_BYTES_PER_S))),
    units.write_bytes_per_s,
    "an integer of bytes per second, 0 for unlimited",
)
Time = Annotated[int, *_marks(units.picoseconds, _up_to(units.LONGEST_PS), _A_TIME)]
Moment = Annotated[
    int,
    *_marks(
        lambda value: units.picoseconds(value, units.LATEST_PS), _up_to(units.LATEST_PS), _A_MOMENT
    ),
]
Size = Annotated[int, *_marks(units.byte_count, _up_to(units.MOST_BYTES), _A_SIZE)]
Bandwidth = Annotated[
    int, *_marks(units.bytes_per_second, _up_to(units.MOST_BYTES_PER_S), _A_BANDWIDTH)
]
_A_POWER = Expect(
    units.A_POWER,
    POWER,
    "mW, W, kW or MW",
    f"0 to {units.write_mw(units.MOST_MW)}",
    units.write_mw,
    "an integer of milliwatts",
)
_A_PRICE = Expect(
    units.A_PRICE,
    PRICE,
    "1/h",
    f"0/h to {units.write_price(units.MOST_PRICE_MICROS)}",
    units.write_price,
    "an integer of millionths",
)
Power = Annotated[int, *_marks(units.milliwatts, _up_to(units.MOST_MW), _A_POWER)]
Price = Annotated[int, *_marks(units.price_micros, _up_to(units.MOST_PRICE_MICROS), _A_PRICE)]
Share = Annotated[Fraction, *_marks(units.share, None, Expect(units.A_SHARE, SHARE))]
