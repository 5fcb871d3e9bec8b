"""Strict settings: pydantic models whose every mistake becomes one line, with its place.

Each field says in ``Expect`` what it takes: the text of its errors and of the table of keys.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from typing import Annotated, Any, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from simmpp.common import units
from simmpp.common.errors import ConfigError
from simmpp.common.units import shown
from simmpp.common.yamlfile import KeyPath

Place = tuple[str, int | None]
"""Where a key was set: a file or ``--set KEY``, and the line."""

Model = TypeVar("Model", bound=BaseModel)


class Strict(BaseModel):
    """Settings that can't be changed and have no other keys than the named ones."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


@dataclass(frozen=True)
class Expect:
    """What a key takes, in words."""

    text: str


def parsed_by(parse: Callable[[Any], object]) -> BeforeValidator:
    """A validator from a function that raises ConfigError for a wrong value."""

    def validate(value: object) -> object:
        try:
            return parse(value)
        except ConfigError as error:
            raise mistake(error.problem) from None

    return BeforeValidator(validate)


def mistake(problem: str) -> PydanticCustomError:
    """What a validator raises; ``problem`` is the rest of the line after the key."""
    return PydanticCustomError("simmpp", "{problem}", {"problem": problem})


def _wrong(value: object, expected: str) -> ConfigError:
    return ConfigError(f"value {shown(value)}: expected {expected}")


def integer(least: int, most: int) -> tuple[BeforeValidator, Expect]:
    """Marks of a whole number from ``least`` to ``most``: ``Annotated[int, *integer(1, 8)]``."""
    expected = f"an integer from {least} to {most}"

    def parse(value: object) -> int:
        if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
            raise _wrong(value, expected)
        return value

    return parsed_by(parse), Expect(expected)


def one_of(*words: str) -> tuple[BeforeValidator, Expect]:
    """Marks of one of these words."""
    expected = " or ".join([", ".join(words[:-1]), words[-1]]) if len(words) > 1 else words[0]

    def parse(value: object) -> str:
        if not isinstance(value, str) or value not in words:
            raise _wrong(value, expected)
        return value

    return parsed_by(parse), Expect(expected)


def _switch(value: object) -> bool:
    if not isinstance(value, bool):
        raise _wrong(value, "true or false")
    return value


def _text(value: object) -> str:
    if not isinstance(value, str) or not value or not value.isprintable():
        raise _wrong(value, "a text of one line")
    return value


Time = Annotated[int, parsed_by(units.picoseconds), Expect(units.A_TIME)]
Size = Annotated[int, parsed_by(units.byte_count), Expect(units.A_SIZE)]
Bandwidth = Annotated[int, parsed_by(units.bytes_per_second), Expect(units.A_BANDWIDTH)]
Share = Annotated[Fraction, parsed_by(units.share), Expect(units.A_SHARE)]
Switch = Annotated[bool, parsed_by(_switch), Expect("true or false")]
Text = Annotated[str, parsed_by(_text), Expect("a text of one line")]


def expectation(model: type[BaseModel], key: str) -> Expect | None:
    """What a field of a model takes, if it says so."""
    field = model.model_fields[key]
    found = [m for m in field.metadata if isinstance(m, Expect)]
    for option in get_args(field.annotation):  # of "X | None"
        found += [m for m in getattr(option, "__metadata__", ()) if isinstance(m, Expect)]
    return found[0] if found else None


def structure(model: type[Model], data: object, places: Mapping[KeyPath, Place]) -> Model:
    """Make a model of plain data.

    Raises ConfigError for the first mistake, with the place of its key from ``places``.
    """
    try:
        return model.model_validate(data)
    except ValidationError as error:
        found = error.errors(include_url=False)
    # an unknown key is often the cause of a missing one
    first = min(found, key=lambda each: each["type"] != "extra_forbidden")
    raise _explained(model, first, places)


def misplaced(
    path: KeyPath, problem: str, places: Mapping[KeyPath, Place], *, within: bool = False
) -> ConfigError:
    """The error for the key at ``path``; ``problem`` follows it in the line.

    With ``within`` the problem names the key itself, and what holds it is named before.
    """
    path = _as_written(path, places)
    where, line = places.get(path, ("", None))
    key = dotted(path[:-1] if within else path)
    prefix = "" if not key or where == f"--set {key}" else f"{key}: "
    return ConfigError(prefix + problem, where=where, line=line)


def dotted(path: KeyPath) -> str:
    """``("policy", 1, "batch")`` -> ``policy[1].batch``."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{_plain(part)}" for part in path)
    return text.removeprefix(".")


def _plain(part: str) -> str:
    return part if part.isprintable() else repr(part)


def _as_written(path: KeyPath, places: Mapping[KeyPath, Place]) -> KeyPath:
    """As far as the user wrote it: short forms have neither the indices nor the last keys."""
    written: KeyPath = ()
    for part in path:
        if not places or (*written, part) in places:
            written = (*written, part)
    return written


def _explained(
    model: type[BaseModel], error: ErrorDetails, places: Mapping[KeyPath, Place]
) -> ConfigError:
    """The one line for one of pydantic's errors."""
    path, kind = tuple(error["loc"]), error["type"]
    if kind == "simmpp":
        return misplaced(path, error["ctx"]["problem"], places)
    if kind == "missing":
        return misplaced(path[:-1], f"missing key {path[-1]!r}", places)
    if kind == "extra_forbidden":
        known = sorted(_model_at(model, path[:-1]).model_fields)
        return misplaced(path, unknown(str(path[-1]), known), places, within=True)
    expected = "a mapping (key: value)" if "model" in kind or "dict" in kind else error["msg"]
    return misplaced(path, f"value {shown(error['input'])}: expected {expected}", places)


def unknown(key: str, known: list[str]) -> str:
    """The problem with a key that doesn't exist: the nearest that does, or all."""
    near = get_close_matches(key, known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"expected one of {', '.join(known)}"
    return f"unknown key {shown(key)}: {hint}"


def _model_at(model: type[BaseModel], path: KeyPath) -> type[BaseModel]:
    for part in path:
        if isinstance(part, str):
            model = submodel(model, part) or model
    return model


def submodel(model: type[BaseModel], key: str) -> type[BaseModel] | None:
    """The model that a field holds, alone, optional or in a tuple."""
    pending: list[Any] = [model.model_fields[key].annotation] if key in model.model_fields else []
    while pending:
        option = pending.pop()
        if isinstance(option, type) and issubclass(option, BaseModel):
            return option
        pending += get_args(option)
    return None
