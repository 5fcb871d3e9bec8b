"""Texts below fields reach help(), in whatever kind of class they stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, NamedTuple

from simmpp.common.documented import documented, fields_below
from simmpp.common.strict import declared, integer


@documented
@dataclass(frozen=True)
class Plain:
    """A plain one."""

    kind: ClassVar[str] = "plain"
    first: int
    """One line."""
    second: list[int] | None = None
    """Two
    lines."""
    silent: int = 0

    def method(self) -> None:
        """Not a field."""


@documented
class Named(NamedTuple):
    """A named one.

    With a second paragraph.
    """

    only: int
    """Its text."""


@declared
class Settings:
    """Checked ones."""

    size: Annotated[int, *integer(1, 8)] = 3
    """How large."""


class Younger(Plain):
    """Has its own."""


def test_help_has_the_texts() -> None:
    assert Plain.__doc__ == (
        "A plain one.\n\nFields\n------\n"
        "first : int\n    One line.\n"
        "second : list[int] | None\n    Two\n    lines.\n"
        "silent : int\n"
    )
    assert Named.__doc__ == (
        "A named one.\n\nWith a second paragraph.\n\nFields\n------\nonly : int\n    Its text."
    )
    assert Settings.__doc__ == (
        "Checked ones.\n\nFields\n------\nsize : an integer from 1 to 8\n    How large."
    )
    assert Plain(1).__doc__ == Plain.__doc__
    assert Younger.__doc__ == "Has its own."


def test_where_there_is_no_source_the_docstring_stays() -> None:
    made = documented(dataclass(type("Made", (), {"__doc__": "Made.", "__annotations__": {}})))
    assert list(fields_below(made)) == []
    assert made.__doc__ == "Made."
