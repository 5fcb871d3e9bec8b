"""Where on the axes of a sweep some of its cases lie, in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from simmpp.common.files import sort_key
from simmpp.common.units import counted
from simmpp.run import words
from simmpp.sweeps.winners.points import Points

MOST_NAMED = 3
"""Values of an axis that are named one by one."""


def extent(points: Points, cases: Sequence[int]) -> str:
    """All there is, of what varies: ``"4 to 64 PEs, memory for 5 % of the scene, 4 scenes"``."""
    return ", ".join(
        _extent(name, _values(points, cases, name))
        for name in points.axes
        if len(_values(points, cases, name)) > 1
    )


def region(
    points: Points, some: Sequence[int], cases: Sequence[int], names: Iterable[str] = ()
) -> str:
    """Where some of all cases lie: ``"up to 16 PEs, rings:3"``; nothing if that is everywhere.

    Each case is told by a point of it. Of all axes, or of those named, these are told along which
    the cases have not all values, if that takes few words: all of the cases are there, others may
    be there too.
    """
    parts = []
    for name in names or points.axes:
        here, everywhere = (_values(points, of, name) for of in (some, cases))
        if len(here) < len(everywhere):
            parts.append(_among(name, here, everywhere))
    return ", ".join(filter(None, parts))


def deciding_axes(points: Points, winners: Mapping[int, str]) -> dict[str, bool]:
    """Axes along which cases differ in nothing else, and whether not all have the same winner.

    ``winners`` by a point of the case. Of an axis without such cases nothing is known.
    """
    found = {}
    for name in points.axes:
        alike: dict[tuple[Any, ...], list[str]] = {}
        for case, winner in winners.items():
            others = tuple(points.at(case, other) for other in points.axes if other != name)
            alike.setdefault(others, []).append(winner)
        if any(len(of) > 1 for of in alike.values()):
            found[name] = any(len(set(of)) > 1 for of in alike.values())
    return found


def _values(points: Points, cases: Sequence[int], name: str) -> list[Any]:
    """The values of an axis that cases have, in its order."""
    there = {points.at(number, name) for number in cases}
    return sorted(there, key=lambda cell: sort_key({"": cell}, ("",)))


def _extent(name: str, values: list[Any]) -> str:
    if all(map(words.is_number, values)):
        return words.between(name, values[0], values[-1])
    if len(values) <= MOST_NAMED:
        return words.values(name, values)
    return counted(len(values), "scene") if name == "scene" else f"{len(values)} values of {name}"


def _among(name: str, here: list[Any], everywhere: list[Any]) -> str:
    """Some values of an axis; nothing where they are many and leave gaps."""
    if name == words.CAPACITY and here != [words.UNBOUNDED]:  # which has no size, but is the most
        here, everywhere = ([v for v in of if v != words.UNBOUNDED] for of in (here, everywhere))
    first, last = everywhere.index(here[0]), everywhere.index(here[-1])
    is_range = last - first + 1 == len(here) > 1 and all(map(words.is_number, everywhere))
    if is_range and first == 0:
        return words.up_to(name, here[-1])
    if is_range and last == len(everywhere) - 1:
        return words.from_on(name, here[0])
    if is_range:
        return words.between(name, here[0], here[-1])
    return words.values(name, here) if len(here) <= MOST_NAMED else ""
