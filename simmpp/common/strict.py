"""Strict settings: each is declared once, and every mistake becomes one line, with its place.

A setting is a field of a class beside what reads it: its type says what it takes, and the text
below it what it means. Such a class is ``Strict`` (a pydantic model) or ``declared`` (a frozen
dataclass that Python callers make as well); ``structure`` makes either of what users write.
From the fields follow the errors, the help, the table of keys and the JSON schema.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import wraps
from inspect import cleandoc
from typing import Annotated, Any, Literal, TypeVar, cast, dataclass_transform, get_args, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetJsonSchemaHandler,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
)
from pydantic.dataclasses import dataclass as pydantic_dataclass
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, PydanticCustomError
from pydantic_core.core_schema import CoreSchema

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.files import in_utf8
from simmpp.common.places import KeyPath, Place, misplaced, unknown
from simmpp.common.units import shown
from simmpp.common.validate import whole

T = TypeVar("T")

_CONFIG = ConfigDict(
    extra="forbid",
    arbitrary_types_allowed=True,
    use_attribute_docstrings=True,
    # Python callers say `refresh_ps` or, as users do, `load_info: {refresh: ...}`
    validate_by_name=True,
    validate_by_alias=True,
)
WRITTEN = "written"
"""Context of what users write: quantities are text with a unit. Python passes numbers, too."""


class Strict(BaseModel):
    """Settings that can't be changed and have no other keys than the named ones."""

    model_config = _CONFIG | ConfigDict(frozen=True)


@dataclass_transform(frozen_default=True)
def declared(cls: type[T]) -> type[T]:
    """A frozen dataclass of settings; wrong arguments are a ConfigError of one line."""
    described = ConfigDict(json_schema_extra={"description": cleandoc(cls.__doc__ or "")})
    settings: Any = pydantic_dataclass(frozen=True, config=_CONFIG | described)(cls)
    init, names = settings.__init__, [field.name for field in fields(settings)]

    @wraps(init)
    def checked(self: T, *arguments: Any, **named: Any) -> None:
        by_name = dict(zip(names, arguments, strict=False))  # so that errors have their names
        try:
            init(self, *arguments[len(names) :], **by_name, **named)
        except ValidationError as error:
            raise _explained(settings, error, {}) from None

    settings.__init__ = checked
    expected = {name: expectation(field) for name, field in settings.__pydantic_fields__.items()}
    return documented(
        cast(type[T], settings), {name: what.passed for name, what in expected.items() if what}
    )


@dataclass(frozen=True, eq=False)
class Expect:
    """What a key takes: in words, with its unit and range, and as a JSON schema."""

    text: str
    schema: Mapping[str, Any] | None = None
    """None where that of the field's type says it."""
    unit: str = ""
    span: str = ""
    """The range, in words."""
    write: Callable[[Any], str] = str
    """A value as a user would write it."""
    number: str = ""
    """What Python may pass in place of a text."""

    @property
    def takes(self) -> str:
        """The text, with the range where it does not say it."""
        return self.text if self.span in self.text else f"{self.text}, {self.span}"

    @property
    def passed(self) -> str:
        """What an argument takes."""
        return f"{self.takes}; or {self.number}" if self.number else self.takes

    def __get_pydantic_json_schema__(
        self, inner: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Called by pydantic."""
        return dict(self.schema) if self.schema is not None else handler(inner)


@dataclass(frozen=True, eq=False)
class Short:
    """A shorter way to write a mapping, or each mapping of a list."""

    text: str
    schema: Mapping[str, Any]

    def __get_pydantic_json_schema__(
        self, inner: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Called by pydantic."""
        long = handler(inner)
        if long.get("type") != "array":
            return {"anyOf": [dict(self.schema), long]}
        one = {"anyOf": [dict(self.schema), long["items"]]}
        return {"anyOf": [*one["anyOf"], {"type": "array", "minItems": 1, "items": one}]}


def parsed_by(
    parse: Callable[[Any], object], passed: Callable[[Any], object] | None = None
) -> BeforeValidator:
    """A validator from a function that raises ConfigError for a wrong value.

    ``passed`` is the one for what Python passes that is no text, where users write something else.
    """

    def validate(value: object, info: ValidationInfo) -> object:
        is_written = info.context == WRITTEN or isinstance(value, str)
        try:
            return parse(value) if passed is None or is_written else passed(value)
        except ConfigError as error:
            raise mistake(error.problem) from None

    return BeforeValidator(validate)


def mistake(problem: str) -> PydanticCustomError:
    """What a validator raises; ``problem`` is the rest of the line after the key."""
    return PydanticCustomError("simmpp", "{problem}", {"problem": problem})


def only(is_right: Callable[[object], bool], expected: Expect) -> tuple[BeforeValidator, Expect]:
    """Marks of a value that is taken as it is, if it is right."""

    def parse(value: object) -> object:
        if not is_right(value):
            raise ConfigError(f"value {shown(value)}: expected {expected.text}")
        return value

    return parsed_by(parse), expected


def integer(least: int, most: int, unit: str = "") -> tuple[BeforeValidator, Expect]:
    """Marks of a whole number from ``least`` to ``most``: ``Annotated[int, *integer(1, 8)]``."""
    schema = {"type": "integer", "minimum": least, "maximum": most}
    expected = Expect(f"an integer from {least} to {most}", schema, unit, f"{least} to {most}")
    return parsed_by(lambda value: whole(value, least, most)), expected


def in_words(words: tuple[str, ...]) -> str:
    """``a, b or c``."""
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def one_of(*words: str) -> tuple[BeforeValidator, Expect]:
    """Marks of one of these words, where no Literal can name them."""
    expected = Expect(in_words(words), {"enum": list(words)})
    return only(lambda value: isinstance(value, str) and value in words, expected)


def is_line(value: object) -> bool:
    """Is it a text of one line? A file's name may hold bytes that are none in UTF-8."""
    return isinstance(value, str) and bool(value) and in_utf8(value).isprintable()


Switch = Annotated[bool, *only(lambda value: isinstance(value, bool), Expect("true or false"))]
_LINE = {"type": "string", "minLength": 1}
Text = Annotated[str, *only(is_line, Expect("a text of one line", _LINE))]


def fields_of(cls: type) -> dict[str, FieldInfo]:
    """The keys of a class of settings; fields that are written inside another key are left out."""
    declared: dict[str, FieldInfo] = getattr(cls, "__pydantic_fields__", {})
    return {key: field for key, field in declared.items() if field.validation_alias is None}


def expectation(field: FieldInfo) -> Expect | None:
    """What a field takes, if it says so."""
    expected = mark_of(field, Expect)
    if expected is None and get_origin(field.annotation) is Literal:
        return Expect(in_words(get_args(field.annotation)))
    return expected


def mark_of(field: FieldInfo, kind: type[T]) -> T | None:
    """The mark of a kind, such as Short, that a field's type has, if it has one."""
    marks = list(field.metadata)
    for option in get_args(field.annotation):  # of "X | None"
        marks += getattr(option, "__metadata__", ())
    return next((mark for mark in marks if isinstance(mark, kind)), None)


def structure(cls: type[T], data: object, places: Mapping[KeyPath, Place]) -> T:
    """Make an instance of a class of settings of what a user writes.

    Raises ConfigError for the first mistake, with the place of its key from ``places``.
    """
    try:
        return TypeAdapter(cls).validate_python(data, context=WRITTEN, by_alias=True, by_name=False)
    except ValidationError as error:
        raise _explained(cls, error, places) from None


UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")
"""Pydantic's errors for a key that isn't one: of its models, and of its dataclasses."""


def _explained(cls: type, errors: ValidationError, places: Mapping[KeyPath, Place]) -> ConfigError:
    """The one line for the first of pydantic's errors."""
    # an unknown key is often the cause of a missing one
    error: ErrorDetails = min(
        errors.errors(include_url=False), key=lambda error: error["type"] not in UNKNOWN
    )
    path, kind = tuple(error["loc"]), error["type"]
    if kind == "simmpp":
        return misplaced(path, error["ctx"]["problem"], places)
    if kind == "missing":
        return misplaced(path[:-1], f"missing key {path[-1]!r}", places)
    if kind in UNKNOWN:
        known = sorted(fields_of(_class_at(cls, path[:-1])))
        return misplaced(path, unknown(str(path[-1]), known), places, within=True)
    expected = error["msg"]
    if kind == "literal_error":
        expected = error["ctx"]["expected"].replace("'", "")
    elif kind.endswith("_type"):  # of a model, a dataclass or a dict
        expected = "a mapping (key: value)"
    return misplaced(path, f"value {shown(error['input'])}: expected {expected}", places)


def _class_at(cls: type, path: KeyPath) -> type:
    for part in path:
        if isinstance(part, str):
            cls = inner_class(cls, part) or cls
    return cls


def is_by_name(cls: type, key: str) -> bool:
    """Does a field hold a class of settings for each name that a user gives?"""
    known = fields_of(cls)
    kind = known[key].annotation if key in known else None
    options = (kind, *get_args(kind))
    return inner_class(cls, key) is not None and any(get_origin(each) is dict for each in options)


def inner_class(cls: type, key: str) -> type | None:
    """The class of settings that a field holds, alone, optional or in a tuple."""
    known = fields_of(cls)
    pending: list[Any] = [known[key].annotation] if key in known else []
    while pending:
        option = pending.pop()
        if isinstance(option, type) and hasattr(option, "__pydantic_fields__"):
            return option
        pending += get_args(option)
    return None
