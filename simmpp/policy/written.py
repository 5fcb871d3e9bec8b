"""How users write what they set of a policy."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from typing import Literal, get_args

from simmpp.common.errors import ConfigError
from simmpp.common.strict import is_line
from simmpp.common.units import byte_count, picoseconds, share, shown
from simmpp.common.validate import MOST_COUNT, whole
from simmpp.policy.file import PolicyFile, read_policy
from simmpp.policy.policy import Policy

LoadInfo = Literal["piggyback", "exact", "none", "sampled", "two"]

LOAD_INFO = "piggyback, exact, none, two, {refresh: 5 ms} or {sampled: 5 ms}"
NEVER, NEVER_PS = "never", 1 << 62
"""A period that no run reaches the end of."""
MIN_LOAD = "a share of n0 / nb such as 12%, or a number of rays"
FILE = "the Python file of a policy of one's own, such as mine.py"
NUMBERS = "a mapping of the policy's own numbers, such as {eagerness: 8}"
MOST_NUMBER = 2**63 - 1


def parse_min_load(value: object) -> Fraction | int:
    """A share of n0 / nb (Fraction) or a number of rays (int), as users write it."""
    if isinstance(value, Fraction) or (isinstance(value, str) and set("%/") & set(value)):
        return share(value)
    return parse_load(value, MIN_LOAD)


def parse_load(
    value: object, expected: str = f"a Fraction or an integer from 0 to {MOST_COUNT}"
) -> Fraction | int:
    """The same, as Python may pass it."""
    try:
        if isinstance(value, Fraction) and 0 <= value <= MOST_COUNT:
            return value
        return whole(value, 0, MOST_COUNT)
    except ConfigError:
        raise ConfigError(f"value {shown(value)}: expected {expected}") from None


def parse_load_info(value: object) -> object:
    """One of the words; ``{refresh: 5 ms}`` is piggyback, and sets ``refresh_ps`` as well.

    So does ``{sampled: 5 ms}`` with ``sample_ps``; the word alone says no period.
    """
    if isinstance(value, dict) and set(value) == {"refresh"}:
        with suppress(ConfigError):
            picoseconds(value["refresh"])
            return "piggyback"
    if isinstance(value, dict) and set(value) == {"sampled"}:
        parse_period(value["sampled"])
        return "sampled"
    if not isinstance(value, str) or value not in get_args(LoadInfo):
        raise ConfigError(f"value {shown(value)}: expected {LOAD_INFO}")
    return value


def parse_period(value: object) -> int | None:
    """Picoseconds, or ``never``."""
    if value is None or (isinstance(value, int) and not isinstance(value, bool) and value >= 0):
        return value
    return NEVER_PS if value == NEVER else picoseconds(value)


def own_policy(value: object) -> object:
    """A policy of one's own; Python may pass the name of its file, or the policy itself."""
    if value is None or isinstance(value, PolicyFile | Policy):
        return value
    if not is_line(value):
        raise ConfigError(f"value {shown(value)}: expected {FILE}")
    try:
        return read_policy(str(value))
    except ConfigError as error:
        raise ConfigError(str(error)) from None  # with its place


def parse_numbers(value: object) -> object:
    """Names with whole numbers, times in picoseconds and sizes in bytes; pairs can be hashed."""
    if value is None:
        return None
    if not isinstance(value, dict | tuple):
        raise ConfigError(f"value {shown(value)}: expected {NUMBERS}")
    return tuple((str(name), _number(str(name), number)) for name, number in dict(value).items())


def _number(name: str, value: object) -> int:
    for read in (lambda v: whole(v, -MOST_NUMBER, MOST_NUMBER), picoseconds, byte_count):
        with suppress(ConfigError):
            return int(read(value))
    raise ConfigError(f"{name}: value {shown(value)}: expected a whole number, a time or a size")
