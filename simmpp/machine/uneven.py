"""PEs that are not alike: some are faster than others, one is late for a while.

What users write are rationals, which are kept as text (``"1/3"``): engines scale whole
picoseconds by whole numbers, and a record can be written as JSON.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from typing import Annotated

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.quantities import SHARE, Moment
from simmpp.common.strict import Expect, integer, parsed_by
from simmpp.common.units import A_SHARE, LATEST_PS, NUMBER, half_up, share, shown

MOST_PROCESSORS = 65536
"""PEs of the largest torus of the presets: Blue Gene/L."""
_MOST, _DIGITS = 1000, 10**4
"""A factor is at most that, or one by that; numerator and denominator have four digits at most."""
_A_FACTOR = f"a factor such as 2, 0.5 or 1/3, from 1/{_MOST} to {_MOST} and of few digits"
_FACTOR = re.compile(rf"\s*({NUMBER})\s*(?:/\s*([0-9]{{1,9}}))?\s*")
_PES = re.compile(r"\s*([0-9]{1,5})\s*(?:-\s*([0-9]{1,5})\s*)?")
A_SPEED = "factors of PEs, such as {0-3: 2, 7: 1/2}, or of shares of them in turn: {25%: 2}"


def factor(value: object) -> str:
    """``0.5`` or ``"1/2"`` -> ``"1/2"``, exactly; a float means its shortest decimal text.

    Raises ConfigError for what is no such factor.
    """
    text = str(value) if isinstance(value, int | float | Fraction) else value
    match = _FACTOR.fullmatch(text) if isinstance(text, str) else None
    if match is not None and not isinstance(value, bool) and int(match[2] or 1):
        number = Fraction(match[1]) / int(match[2] or 1)
        of_few_digits = max(number.numerator, number.denominator) <= _DIGITS
        if of_few_digits and Fraction(1, _MOST) <= number <= _MOST:
            return str(number)
    raise ConfigError(f"value {shown(value)}: expected {_A_FACTOR}")


def named_pes(value: object) -> object:
    """Speeds by the text of their PEs; YAML takes one number for a number."""
    if not isinstance(value, dict) or not value:
        raise ConfigError(f"value {shown(value)}: expected {A_SPEED}")
    named = {str(pes).replace(" ", ""): speed for pes, speed in value.items()}
    if len({pes.endswith("%") for pes in named}) != 1:
        raise ConfigError("expected PEs, or shares of them, but not both")
    for pes in named:
        if not pes.endswith("%") and not _PES.fullmatch(pes):
            raise ConfigError(f"PEs {shown(pes)}: expected a number, 0-3, or a share such as 25%")
    return named


_TEXT = {"type": "string"}
Factor = Annotated[
    str, parsed_by(factor), Expect(_A_FACTOR, {"anyOf": [{"type": "number"}, _TEXT]})
]
Noise = Annotated[str, parsed_by(lambda value: str(share(value))), Expect(A_SHARE, SHARE)]
Speeds = tuple[tuple[str, str], ...]
"""Of some PEs each, as users name them: (("0-3", "2"), ("7", "1/2"))."""


@documented
@dataclass(frozen=True)
class Straggler:
    """A PE that is late for a while."""

    pe: Annotated[int, *integer(0, MOST_PROCESSORS - 1, "PE")] = 0
    """Which one, the first when not given."""
    factor: Factor = "1"
    """How many times as long its tests and rays take."""
    from_ps: Moment = 0
    """What it begins to compute from then on takes longer."""
    to_ps: Moment = LATEST_PS
    """What it begins to compute from then on no longer does, for ever when not given."""


NOBODY = Straggler()


def speeds_of(speed: Speeds, processors: int) -> list[Fraction]:
    """The speed of each PE.

    Raises ConfigError, with the key, for PEs that there are not, or that have two.
    """
    found: dict[int, Fraction] = {}
    for pes, of_each in _ranges(speed, processors):
        if pes[-1] >= processors:
            raise ConfigError(f"PE {pes[-1]}: expected 0 to {processors - 1}", where="speed")
        if twice := found.keys() & set(pes):
            raise ConfigError(f"PE {min(twice)} is in two of them", where="speed")
        found |= dict.fromkeys(pes, of_each)
    return [found.get(pe, Fraction(1)) for pe in range(processors)]


def total_speed(speed: Speeds, processors: int) -> Fraction:
    """That of all PEs together: what they do in the time in which one of speed 1 does 1."""
    return sum(speeds_of(speed, processors), Fraction(0)) if speed else Fraction(processors)


def bound_of(work_ps: int, speed: Speeds, processors: int) -> int:
    """How long so much work takes if all PEs do all the time what they can, rounded up."""
    return ceil(work_ps / total_speed(speed, processors))


def _ranges(speed: Speeds, processors: int) -> Iterator[tuple[range, Fraction]]:
    """PEs by number, or in turn by their share; a share of so few that it has none is left out."""
    so_far = Fraction(0)
    for pes, text in speed:
        if pes.endswith("%"):
            first = half_up(so_far * processors)
            so_far += share(pes)
            if so_far > 1:
                raise ConfigError("shares of more than 100 % of the PEs", where="speed")
            of_share = range(first, half_up(so_far * processors))
            if of_share:
                yield of_share, Fraction(text)
        elif match := _PES.fullmatch(pes):
            first, last = int(match[1]), int(match[2] or match[1])
            if last < first:
                raise ConfigError(f"PEs {pes!r}: expected the lower number first", where="speed")
            yield range(first, last + 1), Fraction(text)


def check_unlike(speed: Speeds, noise: str, straggler: Straggler, processors: int) -> None:
    """Raise ConfigError, with the key, for what can't be on so many PEs."""
    share(noise)
    if speed:
        named_pes(dict(speed))
        for _, text in speed:
            factor(text)
        speeds_of(speed, processors)
    factor(straggler.factor)
    _check_straggler(straggler, processors)


def _check_straggler(straggler: Straggler, processors: int) -> None:
    if straggler == NOBODY:
        return
    if straggler.pe >= processors:
        problem = f"value {straggler.pe}: expected a PE from 0 to {processors - 1}"
        raise ConfigError(problem, where="straggler.pe")
    if Fraction(straggler.factor) < 1:
        problem = f"value {straggler.factor}: expected at least 1, for one that is late"
        raise ConfigError(problem, where="straggler.factor")
    if straggler.from_ps >= straggler.to_ps:
        raise ConfigError("expected a time after `from`", where="straggler.to")
