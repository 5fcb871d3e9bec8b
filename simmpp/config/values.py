"""Values of a configuration that are neither a number, a word nor a quantity with a unit.

Each function returns the value checked, or raises ConfigError with what was expected.
"""

from __future__ import annotations

from fractions import Fraction

from simmpp.common.errors import ConfigError
from simmpp.common.units import picoseconds, share, shown
from simmpp.common.validate import MOST_SEED
from simmpp.config.axes import axes_of

MOST_RAYS = 2**31 - 1
"""Rays are numbered by int32."""
AXES = "a mapping of keys to lists, such as {memory.fraction: [0.1, 0.5, 1]}"
MIN_LOAD = "a share of n0 / nb such as 12%, or a number of rays"
LOAD_INFO = "piggyback, exact, none or {refresh: 5 ms}"
SEEDS = f"a list of different integers from 0 to {MOST_SEED}, such as [0, 1, 2]"
TOLERANCE = "none, or a share above 0% and below 100%, such as 2%"


def min_load(value: object) -> Fraction | int:
    """A share of n0 / nb (Fraction) or a number of rays (int)."""
    if isinstance(value, Fraction):
        return share(value)
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= MOST_RAYS:
        return value
    if isinstance(value, str) and value.rstrip().endswith("%"):
        return share(value)
    raise ConfigError(f"value {shown(value)}: expected {MIN_LOAD}")


def load_info(value: object) -> str | dict[str, int]:
    """One of the three words, or ``{refresh: picoseconds}``."""
    if value in ("piggyback", "exact", "none"):
        return str(value)
    if isinstance(value, dict) and set(value) == {"refresh"}:
        try:
            return {"refresh": picoseconds(value["refresh"])}
        except ConfigError:
            pass
    raise ConfigError(f"value {shown(value)}: expected {LOAD_INFO}")


def seeds(value: object) -> tuple[int, ...]:
    """Different seeds, at least one."""
    if not isinstance(value, list | tuple):
        raise ConfigError(f"value {shown(value)}: expected {SEEDS}")
    for seed in value:
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed <= MOST_SEED:
            raise ConfigError(f"value {shown(seed)} in the list: expected {SEEDS}")
    if not 0 < len(set(value)) == len(value):
        raise ConfigError(f"value {shown(value)}: expected {SEEDS}")
    return tuple(value)


def tolerance(value: object) -> Fraction | None:
    """A share between 0 and 1, or None."""
    if value in ("none", None):
        return None
    try:
        tolerance = share(value)
    except ConfigError:
        tolerance = Fraction(0)
    if not 0 < tolerance < 1:
        raise ConfigError(f"value {shown(value)}: expected {TOLERANCE}")
    return tolerance


def axes(value: object) -> object:
    """Axes of a sweep; the keys themselves are checked later."""
    if not isinstance(value, dict):
        raise ConfigError(f"value {shown(value)}: expected {AXES}")
    axes_of(value)
    return value
