"""Every constant of a machine with what it is, its range and where it comes from, as lines."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any, NamedTuple

from simmpp.common.strict import expectation, fields_of, inner_class, is_by_name
from simmpp.common.units import write_ps
from simmpp.machine.constants import Constants
from simmpp.machine.layers import Layers
from simmpp.machine.messages import COPIED_KINDS
from simmpp.machine.ranges import Known
from simmpp.machine.uneven import Straggler


class Line(NamedTuple):
    """One constant."""

    key: str
    value: str
    """With its unit."""
    span: str
    """The range that it may lie in, where one is stated."""
    source: str


def lines_of(layers: Layers) -> list[Line]:
    """All constants; copies of all kinds of messages are one line where they are alike."""
    lines = [_line(key, known) for key, known in layers.known.items()]
    unlike = [Line(key, _told(of), "", layers.sources[key]) for key, of in layers.unlike.items()]
    return [*_joined(lines), *unlike]


def _told(unlike: Any) -> str:
    """A speed, noise or straggler, much as users write it."""
    if isinstance(unlike, tuple):
        return ", ".join(f"{pes}: {speed}" for pes, speed in unlike)
    if isinstance(unlike, Straggler):
        moments = (write_ps(ps) for ps in (unlike.from_ps, unlike.to_ps))
        return f"PE {unlike.pe}, {unlike.factor} times, {' to '.join(moments)}"
    return f"{float(Fraction(unlike)):g}"


def _line(key: str, known: Known) -> Line:
    ends = () if known.is_exact else (known.low, known.high)
    span = " to ".join(text_of(key, end) for end in ends)
    return Line(key, text_of(key, known.value), span, known.source)


def text_of(key: str, number: int) -> str:
    """A constant with its unit, as a user would set that dotted key to it."""
    model: Any = Constants
    parts = key.split(".")
    while len(parts) > 1:
        if is_by_name(model, parts[0]):
            del parts[1]
        model = inner_class(model, parts.pop(0))
    expected = expectation(fields_of(model)[parts[0]])
    return expected.write(number) if expected else str(number)


def _joined(lines: list[Line]) -> Iterator[Line]:
    """``pack.fixed`` for those of each kind of message that say the same."""
    by_key = {line.key: line for line in lines}
    for line in lines:
        first, _, last = line.key.partition(".")
        kind, _, what = last.partition(".")
        if kind in COPIED_KINDS and what:
            alike = [by_key.get(f"{first}.{each}.{what}") for each in COPIED_KINDS]
            if {each and each[1:] for each in alike} == {line[1:]}:
                if kind == COPIED_KINDS[0]:
                    yield line._replace(key=f"{first}.{what}")
                continue
        yield line
