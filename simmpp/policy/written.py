"""How users write what they set of a policy."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from typing import Annotated, Literal, get_args

from pydantic import InstanceOf

from simmpp.common.errors import ConfigError
from simmpp.common.quantities import TIME
from simmpp.common.strict import Expect, Short, in_words, integer, is_line, parsed_by
from simmpp.common.units import byte_count, picoseconds, share, shown
from simmpp.common.validate import MOST_COUNT, whole
from simmpp.policy.file import PolicyFile, read_policy
from simmpp.policy.policy import Policy
from simmpp.policy.table import POLICIES

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


class OwnName(str):
    """The name of a policy that a file gives."""


def _name(value: object) -> object:
    """One of the package's policies, as there are then: Python may add some."""
    if isinstance(value, OwnName):
        return str(value)
    if not isinstance(value, str) or value not in POLICIES:
        raise ConfigError(f"value {shown(value)}: expected {in_words(tuple(POLICIES))}")
    return value


# --- what these make fields of settings ---

NAME = Short(in_words(tuple(POLICIES)), {"enum": list(POLICIES)})
"""A policy's name alone is short for it."""
PolicyName = Annotated[
    str, parsed_by(_name), Expect(in_words(tuple(POLICIES)), {"enum": list(POLICIES)})
]
RayCount = Annotated[int, *integer(1, MOST_COUNT, "rays")]
_RAYS = {"type": "integer", "minimum": 0, "maximum": MOST_COUNT}
MinLoad = Annotated[
    Fraction | int,
    parsed_by(parse_min_load, parse_load),
    Expect(MIN_LOAD, {"anyOf": [_RAYS, {"type": "string", "pattern": "[%/]"}]}, "% or rays"),
]
_PERIODS = {"refresh": TIME, "sampled": {"anyOf": [TIME, {"const": NEVER}]}}
_WITH_PERIOD = [
    {"type": "object", "properties": {key: of}, "required": [key], "additionalProperties": False}
    for key, of in _PERIODS.items()
]
_INFO = {"anyOf": [{"enum": list(get_args(LoadInfo))}, *_WITH_PERIOD]}
KnownLoads = Annotated[LoadInfo, parsed_by(parse_load_info), Expect(LOAD_INFO, _INFO)]
OwnPolicy = Annotated[
    InstanceOf[PolicyFile] | InstanceOf[Policy] | None,
    parsed_by(own_policy),
    Expect(FILE, {"type": "string", "minLength": 1}),
]
OwnNumbers = Annotated[
    tuple[tuple[str, int], ...] | None,
    parsed_by(parse_numbers),
    Expect(NUMBERS, {"type": "object"}),
]
