"""The constants of a machine as users write them: the keys of presets and of their overrides.

All follow from the fields of ``Machine``, where each is declared; here any number may be given.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from typing import Annotated, Any, Literal, get_origin, get_type_hints

from pydantic import Field, create_model

from simmpp.common.documented import fields_below
from simmpp.common.errors import ConfigError
from simmpp.common.quantities import TIME
from simmpp.common.strict import Expect, Short, Strict, parsed_by
from simmpp.common.units import A_TIME, picoseconds, shown
from simmpp.machine.machine import (
    MOST_LEVELS,
    Copies,
    CopyCost,
    FatTree,
    Level,
    Levels,
    Machine,
    TestCost,
)
from simmpp.machine.messages import COPIED_KINDS
from simmpp.machine.uneven import A_SPEED, Factor, Speeds, Straggler, named_pes

OTHERS = ("name", "sources")
"""Fields of a Machine that no user sets."""
_KINDS = ("A request for an object.", "An object.", "A batch of rays.", "The sender's load alone.")
"""In the order of COPIED_KINDS."""
_WORDS = ("topology", "service", "contention")
UNLIKE = ("speed", "noise", "straggler")
"""What makes PEs, or moments, unlike others: no constants of a product."""
_NAME = re.compile("[A-Za-z][A-Za-z0-9_-]{0,30}")
_LEVELS = "the blocks from the inside out by a name for each, such as node, group, system"


def key_of(field: str) -> str:
    """``send_startup_ps`` -> ``send_startup``: users write the unit with the value."""
    for unit in ("_ps", "_mw", "_micros"):
        field = field.removesuffix(unit)
    return field.replace("bytes_per_s", "bandwidth")


def long_test(value: object) -> object:
    """One time for all kinds of primitives as the mapping it is short for."""
    if isinstance(value, dict | TestConstants):
        return value
    try:
        picoseconds(value)
    except ConfigError as error:
        raise ConfigError(f"{error.problem}, or a mapping by kind of primitive") from None
    alike = dict.fromkeys(("sphere", "cone", "polygon", "mesh"), value)
    return alike | {"per_triangle": 0, "log2": 0}


def named_levels(value: object) -> object:
    """Levels below names that can be part of a key."""
    if not isinstance(value, dict) or not 0 < len(value) <= MOST_LEVELS:
        raise ConfigError(f"value {shown(value)}: expected {_LEVELS}, 1 to {MOST_LEVELS}")
    for name in value:
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise ConfigError(f"name {shown(name)}: expected letters, digits, - and _")
    return value


# --- models of which every key may be left out, made of the classes of constants ---


def optional_fields(cls: type, nested: Mapping[Any, Any]) -> dict[str, Any]:
    """Fields of a model with the keys that users write: choices with their default, numbers None.

    ``nested`` has the model, and its default, of each class of constants that a field may hold.
    """
    hints = get_type_hints(cls, include_extras=True)
    meanings = {name: " ".join(text.split()) for name, _, text in fields_below(cls)}
    model: dict[str, Any] = {}
    for constant in fields(cls):
        if constant.name not in OTHERS:
            hint, default = hints[constant.name], None
            if hint in nested:
                hint, default = nested[hint]
            elif get_origin(hint) is Literal:
                default = constant.default
            else:
                hint |= None
            meaning = Field(default=default, description=meanings[constant.name])
            model[key_of(constant.name)] = (hint, meaning)
    return model


CopyConstants: Any = create_model("CopyConstants", __base__=Strict, **optional_fields(CopyCost, {}))
_of_kinds: dict[str, Any] = {
    kind: (CopyConstants, Field(default=CopyConstants(), description=meaning))
    for kind, meaning in zip(COPIED_KINDS, _KINDS, strict=True)
}
CopiesConstants: Any = create_model("CopiesConstants", __base__=CopyConstants, **_of_kinds)
TestConstants: Any = create_model("TestConstants", __base__=Strict, **optional_fields(TestCost, {}))
FatTreeConstants: Any = create_model(
    "FatTreeConstants", __base__=Strict, **optional_fields(FatTree, {})
)
StragglerConstants: Any = create_model(
    "StragglerConstants", __base__=Strict, **optional_fields(Straggler, {})
)
LevelConstants: Any = create_model("LevelConstants", __base__=Strict, **optional_fields(Level, {}))
_NESTED = {
    Copies: (CopiesConstants, CopiesConstants()),
    TestCost: (
        Annotated[TestConstants, parsed_by(long_test), Short(A_TIME, TIME)],
        TestConstants(),
    ),
    Levels: (
        Annotated[dict[str, LevelConstants] | None, parsed_by(named_levels), Expect(_LEVELS)],
        None,
    ),
    FatTree: (FatTreeConstants | None, None),
    Speeds: (Annotated[dict[str, Factor] | None, parsed_by(named_pes), Expect(A_SPEED)], None),
    Straggler: (StragglerConstants | None, None),
}
_All: Any = create_model("_All", __base__=Strict, **optional_fields(Machine, _NESTED))


class Constants(_All):  # type: ignore[misc]  # mypy can't know fields that are made
    """Any number of a machine's constants; what is None is left to the preset."""

    def flat(self) -> dict[str, int]:
        """The constants that are given, by dotted key (``pack.rays.bandwidth``): the numbers.

        What is given for all kinds of messages appears under each kind.
        """
        given = _numbers(self, "")
        for key, value in self:
            if key in UNLIKE:
                continue
            if isinstance(value, CopiesConstants):
                for kind in COPIED_KINDS:
                    given |= _numbers(value, f"{key}.{kind}.")
                    given |= _numbers(getattr(value, kind), f"{key}.{kind}.")
            elif isinstance(value, Strict):
                given |= _numbers(value, f"{key}.")
            elif isinstance(value, dict):
                for name, level in value.items():
                    given |= _numbers(level, f"{key}.{name}.")
        return given

    def words(self) -> dict[str, str]:
        """The choices that are made: ``contention``, ``topology``, ``service``."""
        return {key: value for key, value in self if key in _WORDS and value is not None}

    def unlike(self) -> dict[str, Any]:
        """Those of UNLIKE that are given, as ``Machine`` has them.

        Raises ConfigError for a straggler without a factor.
        """
        found = {key: value for key, value in self if key in UNLIKE and value is not None}
        if "speed" in found:
            found["speed"] = tuple(found["speed"].items())
        if "straggler" in found:
            found["straggler"] = _straggler(found["straggler"])
        return found


def _straggler(given: Any) -> Straggler:
    if given.factor is None:
        raise ConfigError("missing key 'factor'", where="straggler")
    numbers = _arguments(Straggler, _numbers(given, ""), "")
    return Straggler(**numbers, factor=given.factor)


def _numbers(model: Strict, prefix: str) -> dict[str, int]:
    return {prefix + key: value for key, value in model if isinstance(value, int)}


def machine_of(numbers: Mapping[str, int], **others: Any) -> Machine:
    """The machine with these numbers, by dotted key as in ``flat``, and these other fields."""
    return Machine(**_arguments(Machine, numbers, ""), **others)


def _arguments(cls: Any, numbers: Mapping[str, int], prefix: str) -> dict[str, Any]:
    """Those of the numbers that a class of constants is made of, by its fields."""
    arguments: dict[str, Any] = {}
    for name, hint in _hints(cls).items():
        key = prefix + key_of(name)
        if key in numbers:
            arguments[name] = numbers[key]
        elif hint == Copies:
            kinds = (_arguments(CopyCost, numbers, f"{key}.{kind}.") for kind in COPIED_KINDS)
            arguments[name] = tuple(CopyCost(**kind) for kind in kinds)
        elif hint in (TestCost, FatTree):
            arguments[name] = hint(**_arguments(hint, numbers, f"{key}."))
    return arguments


_hints = cache(get_type_hints)
