"""Two tables of points side by side: what both have, what only one has, and how far values went."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from typing import TypeVar

Key = TypeVar("Key", bound=Hashable)
Entry = TypeVar("Entry")


def matched(
    before: Mapping[Key, Entry], after: Mapping[Key, Entry]
) -> list[tuple[Key, Entry | None, Entry | None]]:
    """Each key with what it had and has; None where it is new or gone."""
    return [(key, before.get(key), after.get(key)) for key in dict.fromkeys([*before, *after])]


def extremes(changes: Iterable[float]) -> dict[str, str]:
    """The least and the largest of some relative changes, as cells of a table."""
    ordered = sorted(changes)
    ends = (percent(ordered[0]), percent(ordered[-1])) if ordered else ("", "")
    return dict(zip(("from", "to"), ends, strict=True))


def percent(change: float) -> str:
    """0.01234 -> ``+1.23 %``."""
    return f"{change * 100:+.3g} %"
