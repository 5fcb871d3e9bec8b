"""How the points of any sweep become figures: what runs along, what stands side by side."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from simmpp.common.files import Row, sort_key
from simmpp.run import words

PREFERRED = ("fraction", "processors")
"""Abscissas, of those with equally many values."""
FACETS = ("folder", "policy")
"""Side by side before all others, where they are axes."""
MOST_PANELS = 12
"""Panels side by side; an axis with more values becomes plates."""
Axes = Mapping[str, Sequence[Any]]
"""Values of each axis that has several, sorted."""


@dataclass(frozen=True)
class Arrangement:
    """What becomes of each axis of a sweep: run along it, panels for it, or plates."""

    abscissa: str
    values: tuple[Any, ...]
    """Of the abscissa."""
    facet: str | None
    """One panel for each of its values; one panel in all where there is no such axis."""
    plate_axes: tuple[str, ...]
    """The others: one plate of panels for each combination of them that there is."""


def abscissas(axes: Axes) -> list[str]:
    """Axes worth running along, the best first: numbers before texts, then those with most values.

    Of texts only the best, as nothing lies between them; none at all: the policies themselves.
    """
    ranked = sorted(
        axes, key=lambda name: (-len(axes[name]), PREFERRED.index(name) if name in PREFERRED else 9)
    )
    numeric = [name for name in ranked if all(map(words.is_number, axes[name]))]
    return numeric or ranked[:1] or ["policy"]


def arrange(
    rows: Sequence[Row], axes: Axes, abscissa: str, facet: str | None = None
) -> Arrangement:
    """Give each axis its place.

    An axis that follows from the abscissa (a shape of the torus for each number of PEs) needs none.
    ``facet`` forces an axis to be side by side, such as the policy.
    """
    rest = [name for name in axes if name != abscissa and not _follows(rows, name, abscissa)]
    few = [name for name in rest if len(axes[name]) <= MOST_PANELS]
    if facet is None and few:
        facet = max(few, key=lambda name: (name in FACETS, name == "scene", len(axes[name])))
    values = axes.get(abscissa) or list(dict.fromkeys(row[abscissa] for row in rows))
    return Arrangement(
        abscissa, tuple(values), facet, tuple(name for name in rest if name != facet)
    )


def _follows(rows: Sequence[Row], name: str, abscissa: str) -> bool:
    """Whether each value of the abscissa has one value of the axis; scenes are kept apart."""
    values: dict[Hashable, set[Hashable]] = {}
    for row in rows:
        values.setdefault(row[abscissa], set()).add(row[name])
    return name != "scene" and all(len(others) == 1 for others in values.values())


def plates(
    rows: Sequence[Row], arrangement: Arrangement
) -> dict[str, dict[str, list[tuple[int, Row]]]]:
    """Numbered rows of each panel of each plate, by what these are of, in the order of the axes."""
    facet = (arrangement.facet,) if arrangement.facet else ()
    names = (*arrangement.plate_axes, *facet)
    numbered = sorted(enumerate(rows), key=lambda numbered_row: sort_key(numbered_row[1], names))
    return {
        plate: _split(of_plate, facet)
        for plate, of_plate in _split(numbered, arrangement.plate_axes).items()
    }


def _split(
    numbered: Iterable[tuple[int, Row]], names: Sequence[str]
) -> dict[str, list[tuple[int, Row]]]:
    """Rows by the values of some axes, in words; values that differ little have words that do."""
    groups: dict[tuple[Hashable, ...], list[tuple[int, Row]]] = {}
    for number, row in numbered:
        groups.setdefault(tuple(row[name] for name in names), []).append((number, row))
    by_text: dict[str, list[tuple[int, Row]]] = {}
    for group in groups.values():
        text = words.point(group[0][1], names)
        # 1/3 and 0.3333 are both "33.3 %": the second gets a number, not the first one's rows.
        by_text[text if text not in by_text else f"{text} ({len(by_text) + 1})"] = group
    return by_text
