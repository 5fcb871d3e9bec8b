"""The question of ``simmpp advise``: the goal, numbers of nodes, and what is to choose from."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Any

from pydantic import PlainSerializer, model_validator

from simmpp.common.errors import ConfigError
from simmpp.common.quantities import TIME
from simmpp.common.strict import Expect, Strict, integer, mistake, parsed_by
from simmpp.common.units import LATEST_PS, picoseconds, share, shown, write_ps
from simmpp.machine.machine import MOST_PROCESSORS

GOALS = ("time", "node-seconds")
WITHIN = "least nodes within"
"""The third goal: a mapping of it to a time."""
MOST_SIZES = 60
"""Numbers of nodes in one question: as many as there are candidates at most."""

_GOAL = f"time, node-seconds or {{{WITHIN}: 10 s}}"
_GOAL_SCHEMA = {
    "anyOf": [
        {"enum": list(GOALS)},
        {
            "type": "object",
            "properties": {WITHIN: TIME},
            "required": [WITHIN],
            "additionalProperties": False,
        },
    ]
}
_SIZES = f"a list of 1 to {MOST_SIZES} different numbers of nodes, such as [8, 16, 32]"
_SIZES_SCHEMA = {
    "type": "array",
    "items": {"type": "integer", "minimum": 1, "maximum": MOST_PROCESSORS},
    "minItems": 1,
    "maxItems": MOST_SIZES,
    "uniqueItems": True,
}
_SHARE = "a share from 0% to below 100%, such as 5%"
_CANDIDATES = (
    "all, or a list of names (`simmpp advise --list` tells them) and of mappings with a name and "
    "the keys to set"
)


def _goal(value: object) -> str | int:
    """One of the words, or the time within which it has to be done, in ps."""
    if value in GOALS:
        return str(value)
    if isinstance(value, dict) and set(value) == {WITHIN}:
        limit = value[WITHIN]
        time_ps = limit if type(limit) is int and limit > 0 else picoseconds(limit, LATEST_PS)
        if time_ps > 0:
            return time_ps
    if type(value) is int and value > 0:  # of what was checked before
        return value
    raise ConfigError(f"value {shown(value)}: expected {_GOAL}")


def _sizes(value: object) -> tuple[int, ...] | None:
    if value is None:
        return None
    sizes = list(value) if isinstance(value, list | tuple) else []
    right = [type(size) is int and 0 < size <= MOST_PROCESSORS for size in sizes]
    if not (0 < len(sizes) <= MOST_SIZES and all(right) and len(set(sizes)) == len(sizes)):
        raise ConfigError(f"value {shown(value)}: expected {_SIZES}")
    return tuple(sizes)


def _indifference(value: object) -> Fraction:
    try:
        found = share(value)
    except ConfigError:
        found = Fraction(1)
    if found == 1:
        raise ConfigError(f"value {shown(value)}: expected {_SHARE}")
    return found


def _candidates(value: object) -> tuple[Any, ...] | None:
    """Names and mappings, None for all; the names themselves are checked by who knows them."""
    if value in ("all", None):
        return None
    entries = list(value) if isinstance(value, list | tuple) else []
    named = [
        isinstance(entry, str) or (isinstance(entry, dict) and isinstance(entry.get("name"), str))
        for entry in entries
    ]
    if not entries or not all(named):
        raise ConfigError(f"value {shown(value)}: expected {_CANDIDATES}")
    return tuple(entries)


def _written(goal: str | int) -> object:
    return goal if isinstance(goal, str) else {WITHIN: write_ps(goal)}


class AdviseSettings(Strict):
    """What `simmpp advise` is asked."""

    goal: Annotated[
        str | int, parsed_by(_goal), Expect(_GOAL, _GOAL_SCHEMA), PlainSerializer(_written)
    ] = "time"
    """What is to be least: the time, nodes times time, or the nodes with which it takes no
    longer."""
    processors: Annotated[
        tuple[int, ...] | None, parsed_by(_sizes), Expect(_SIZES, _SIZES_SCHEMA)
    ] = None
    """Numbers of nodes to choose from; without it and a budget, `processors` alone."""
    budget: Annotated[int | None, *integer(1, MOST_PROCESSORS, "nodes")] = None
    """In place of the list: nodes that there are, of which all, a half, a quarter ... may be
    used."""
    indifference: Annotated[
        Fraction,
        parsed_by(_indifference),
        Expect(_SHARE, {"anyOf": [{"type": "number"}, {"type": "string"}]}),
    ] = Fraction(1, 20)
    """A difference that does not matter: what is no worse by more is as good as the best."""
    candidates: Annotated[
        tuple[Any, ...] | None,
        parsed_by(_candidates),
        Expect(_CANDIDATES, {"anyOf": [{"const": "all"}, {"type": "array", "minItems": 1}]}),
    ] = None
    """What to choose from at each number of nodes: `all` that the package knows, some of these by
    their names, or settings of one's own (policy, placement and memory, as in `sweep.points`)."""

    @model_validator(mode="after")
    def _nodes_once(self) -> AdviseSettings:
        if self.processors is not None and self.budget is not None:
            raise mistake("expected processors or budget, got both")
        return self
