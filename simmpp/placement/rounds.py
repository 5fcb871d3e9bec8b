"""How users say when a round of rays begins, and where the tallies of objects are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.strict import Expect, parsed_by
from simmpp.common.units import shown
from simmpp.common.validate import MOST_COUNT, require_whole


@documented
@dataclass(frozen=True)
class Window:
    """Roots of round k + window start when round k and all before it are over."""

    window: int
    """Rounds that may be there together; 1 is a barrier."""

    def __post_init__(self) -> None:
        require_whole("window", self.window, 1, MOST_COUNT)


Tallies = Literal["reduce", "send", "none"]

BARRIER: Literal["barrier"] = "barrier"
_ROUNDS = "barrier or {window: 4}"
_WINDOW_SCHEMA = {
    "type": "object",
    "properties": {"window": {"type": "integer", "minimum": 1, "maximum": MOST_COUNT}},
    "required": ["window"],
    "additionalProperties": False,
}
_SCHEMA = {"anyOf": [{"enum": [BARRIER]}, _WINDOW_SCHEMA]}


def _rounds(value: object) -> object:
    """The word, or ``{window: 4}``."""
    if isinstance(value, dict) and set(value) == {"window"}:
        return Window(value["window"])
    if isinstance(value, Window) or value == BARRIER:
        return value
    raise ConfigError(f"value {shown(value)}: expected {_ROUNDS}")


RoundRule = Annotated[Literal["barrier"] | Window, parsed_by(_rounds), Expect(_ROUNDS, _SCHEMA)]


def window_of(rule: Literal["barrier"] | Window) -> int:
    """Rounds that may be there together."""
    return rule.window if isinstance(rule, Window) else 1
