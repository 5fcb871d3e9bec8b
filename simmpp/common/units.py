"""Quantities with units: text from users to exact integers (ps, bytes, bytes per second), and back.

No float holds a quantity: text becomes a fraction, and the fraction an integer, once.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from simmpp.common.errors import ConfigError

if TYPE_CHECKING:
    import pint

UNLIMITED = 0
"""Bandwidth (bytes per second) of a copy or link that takes no time."""

LONGEST_PS = 10 * 10**12
"""Longest cost of one thing, 10 s: the clock is int64 picoseconds and ends after 106 days."""
LATEST_PS = 4 * 10**18
"""Latest moment that can be named, 46 days: a run is stopped a week later."""
MOST_BYTES = 10**17
MOST_MW = 10**12
"""A gigawatt."""
MOST_PRICE_MICROS = 10**15
LEAST_BYTES_PER_S, MOST_BYTES_PER_S = 1000, 9 * 10**15

A_TIME = "a time such as '12 us'"
A_SIZE = "a size such as '64 MB'"
A_BANDWIDTH = "a bandwidth such as '340 MB/s' or '10 Gbit/s', or 'unlimited'"
A_POWER = "a power such as '630 W'"
A_PRICE = "a price of an hour such as '4.92/h'"
A_SHARE = "a share from 0 to 1, such as 0.1, 10% or 1/64"

_DEFINITIONS = [
    "second = [time] = s",
    "minute = 60 * second = min",
    "byte = [information] = B",
    "watt = [power] = W",
    "bit = [bits] = b",  # no part of a byte: '64 Mb' of memory would be a mistake for MB
    "pico- = 1e-12 = p-",
    "nano- = 1e-9 = n-",
    "micro- = 1e-6 = u- = µ- = μ-",
    "milli- = 1e-3 = m-",
    "kilo- = 1e3 = k-",
    "mega- = 1e6 = M-",
    "giga- = 1e9 = G-",
    "tera- = 1e12 = T-",
    "kibi- = 2**10 = Ki-",
    "mebi- = 2**20 = Mi-",
    "gibi- = 2**30 = Gi-",
    "tebi- = 2**40 = Ti-",
]

# Neither signs, operators nor long exponents: pint would evaluate them, Fraction expand them.
NUMBER = r"[0-9]{1,30}(?:\.[0-9]{0,30})?(?:[eE][+-]?[0-9]{1,2})?"
_QUANTITY = re.compile(rf"\s*({NUMBER})\s*([A-Za-zµμ]{{1,16}}(?:/[A-Za-z]{{1,16}})?)\s*")
_PRICE = re.compile(rf"\s*({NUMBER})\s*/\s*h\s*")
_SHARE = re.compile(rf"\s*({NUMBER})\s*(?:(%)|/\s*([0-9]{{1,18}}))?\s*")


@cache
def _registry() -> pint.UnitRegistry[Fraction]:
    """Pint with these units only and exact fractions; its own list knows barns, too."""
    import pint  # takes a quarter of a second

    return pint.UnitRegistry(_DEFINITIONS, non_int_type=Fraction)


@cache
def _in(text: str, unit: str) -> Fraction | None:
    """``text`` as an exact number of ``unit``; None if it isn't such a quantity."""
    import pint

    match = _QUANTITY.fullmatch(text)
    if match is None:
        return None
    try:
        return Fraction(_registry().Quantity(Fraction(match[1]), match[2]).to(unit).magnitude)
    except (pint.PintError, AttributeError):
        return None


def _quantity(
    value: object,
    unit: str,
    expected: str,
    most: int,
    in_text: Callable[[int], str],
    eighth: str = "",
) -> Fraction:
    """A number of ``unit``; what is given in an ``eighth`` of it, too."""
    if type(value) is int and value == 0:
        return Fraction(0)
    number = _in(value, unit) if isinstance(value, str) else None
    if number is None and isinstance(value, str) and eighth:
        eighths = _in(value, eighth)
        number = None if eighths is None else eighths / 8
    if number is None:
        raise ConfigError(f"value {shown(value)}: expected {expected}")
    if number > most:
        raise ConfigError(f"value {shown(value)}: expected {expected}, at most {in_text(most)}")
    return number


def half_up(number: Fraction) -> int:
    """The nearest integer; halves go up."""
    return (2 * number.numerator + number.denominator) // (2 * number.denominator)


def picoseconds(value: object, most_ps: int = LONGEST_PS) -> int:
    """``"12 us"`` -> 12000000; halves of a picosecond go up, 0 needs no unit.

    Raises ConfigError for anything else but a time up to ``most_ps``, 10 s for the cost of one
    thing.
    """
    return half_up(_quantity(value, "picosecond", A_TIME, most_ps, format_ps))


def byte_count(value: object) -> int:
    """``"64 MB"`` -> 64000000, ``"1 KiB"`` -> 1024; 0 needs no unit.

    Raises ConfigError for anything else but a whole number of bytes.
    """
    number = _quantity(value, "byte", A_SIZE, MOST_BYTES, format_bytes)
    if number.denominator != 1:
        raise ConfigError(f"value {shown(value)}: expected a whole number of bytes")
    return number.numerator


def bytes_per_second(value: object) -> int:
    """``"340 MB/s"`` -> 340000000, ``"1 Gbit/s"`` -> 125000000, ``"unlimited"`` -> UNLIMITED.

    A capital B is a byte, b or bit an eighth of it: ``"1 Gb/s"`` is ``"0.125 GB/s"``.
    Raises ConfigError for anything else but at least 1 kB/s: a bandwidth of nothing never ends.
    """
    if value == "unlimited":
        return UNLIMITED
    bounds = MOST_BYTES_PER_S, format_bytes_per_s
    rate = half_up(_quantity(value, "byte / second", A_BANDWIDTH, *bounds, "bit / second"))
    if rate < LEAST_BYTES_PER_S:
        raise ConfigError(f"value {shown(value)}: expected {A_BANDWIDTH}, at least 1 kB/s")
    return rate


def milliwatts(value: object) -> int:
    """``"630 W"`` -> 630000; 0 needs no unit.

    Raises ConfigError for anything else but a power.
    """
    return half_up(1000 * _quantity(value, "watt", A_POWER, MOST_MW // 1000, format_watts))


def price_micros(value: object) -> int:
    """``"4.92/h"`` -> 4920000 millionths of a currency, whichever it is.

    Raises ConfigError for anything else.
    """
    match = _PRICE.fullmatch(value) if isinstance(value, str) else None
    price = half_up(10**6 * Fraction(match[1])) if match else -1
    if not 0 <= price <= MOST_PRICE_MICROS:
        raise ConfigError(f"value {shown(value)}: expected {A_PRICE}")
    return price


def share(value: object) -> Fraction:
    """``"12%"``, ``0.12`` or ``"3/25"`` -> Fraction(3, 25), exactly.

    Raises ConfigError outside 0 ... 1. A float means its shortest decimal text: 0.1 is 1/10.
    """
    text = str(value) if isinstance(value, int | float) and not isinstance(value, bool) else value
    if isinstance(value, Fraction):
        text = f"{value.numerator}/{value.denominator}"
    match = _SHARE.fullmatch(text) if isinstance(text, str) else None
    divisor = (100 if match[2] else int(match[3] or 1)) if match else 0
    number = Fraction(match[1]) / divisor if match and divisor else None
    if number is None or number > 1:
        raise ConfigError(f"value {shown(value)}: expected {A_SHARE}")
    return number


def shown(value: object) -> str:
    """``value`` as one short piece of a line: text quoted, the rest as YAML writes it."""
    if value is None:
        return "empty"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and value.bit_length() > 200:
        return "too many digits"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


TIMES = (("s", 10**12), ("ms", 10**9), ("us", 10**6), ("ns", 1000), ("ps", 1))
SIZES = (("TB", 10**12), ("GB", 10**9), ("MB", 10**6), ("kB", 1000), ("B", 1))
POWERS = (("MW", 10**9), ("kW", 10**6), ("W", 1000), ("mW", 1))
"""Units of what is counted in ps, bytes and mW, the largest first."""


def _with_prefix(number: int, units: Sequence[tuple[str, int]]) -> str:
    unit, size = next((u for u in units if number >= u[1]), units[-1])
    return f"{number / size:.6g} {unit}"


def _exactly(number: int, units: Sequence[tuple[str, int]]) -> str:
    unit, size = next((u for u in units if number >= u[1]), units[-1])
    return f"{Decimal(number) / size:f} {unit}"


def write_ps(time_ps: int) -> str:
    """The text that ``picoseconds`` makes this number of; so the others, and all digits."""
    return _exactly(time_ps, TIMES)


def write_bytes(size_bytes: int) -> str:
    """64000000 -> ``"64 MB"``."""
    return _exactly(size_bytes, SIZES)


def write_bytes_per_s(rate: int) -> str:
    """340000000 -> ``"340 MB/s"``; UNLIMITED -> ``"unlimited"``."""
    return "unlimited" if rate == UNLIMITED else write_bytes(rate) + "/s"


def write_mw(power_mw: int) -> str:
    """1275000 -> ``"1.275 kW"``."""
    return _exactly(power_mw, POWERS)


def write_price(micros: int) -> str:
    """4920000 -> ``"4.92/h"``."""
    return f"{(Decimal(micros) / 10**6).normalize():f}/h"


def format_watts(power_w: int) -> str:
    """1000 -> ``"1 kW"``."""
    return write_mw(1000 * power_w)


def format_ps(time_ps: int) -> str:
    """12000000 -> ``"12 us"``: for people, up to six digits."""
    return _with_prefix(time_ps, TIMES) if time_ps else "0 s"


def format_bytes(size_bytes: int) -> str:
    """64000000 -> ``"64 MB"``: for people, up to six digits."""
    return _with_prefix(size_bytes, SIZES)


def format_bytes_per_s(rate: int) -> str:
    """340000000 -> ``"340 MB/s"``; UNLIMITED -> ``"unlimited"``."""
    return "unlimited" if rate == UNLIMITED else format_bytes(rate) + "/s"


def counted(number: int, noun: str) -> str:
    """``"1 mesh"``, ``"2 meshes"``."""
    ending = "" if number == 1 else "es" if noun.endswith("sh") else "s"
    return f"{number} {noun}{ending}"
