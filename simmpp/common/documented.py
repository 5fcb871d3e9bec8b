"""Help that explains fields: the text below each of them, which only readers of the code saw."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import cached_property
from inspect import cleandoc, getsource
from itertools import pairwise
from textwrap import dedent, indent
from typing import TypeVar

T = TypeVar("T")
HEADING = "Fields\n------\n"


def documented(cls: type[T], takes: Mapping[str, str] | None = None) -> type[T]:
    """Have ``help(cls)`` list the fields; ``takes`` says what some of them take, else their types.

    The source is read when somebody asks for help.
    """
    cls.__doc__ = _Doc(cls, takes or {})  # type: ignore[assignment]  # Python asks it for the text
    return cls


class _Doc:
    """The docstring of a class, followed by its fields."""

    def __init__(self, cls: type, takes: Mapping[str, str]) -> None:
        self._cls, self._takes, self._plain = cls, takes, cls.__doc__ or ""

    def __get__(self, instance: object, owner: type | None = None) -> str:
        return self._text

    @cached_property
    def _text(self) -> str:
        plain = cleandoc(self._plain)
        entries = [
            f"{name} : {self._takes.get(name, kind)}\n{indent(text, '    ')}"
            for name, kind, text in fields_below(self._cls)
        ]
        return f"{plain}\n\n{HEADING}" + "\n".join(entries) if entries else plain


def fields_below(cls: type) -> Iterator[tuple[str, str, str]]:
    """Name, type and text of each field of a class; none where there is no source to be read."""
    try:
        (definition,) = ast.parse(dedent(getsource(cls))).body
    except (OSError, TypeError):
        return
    assert isinstance(definition, ast.ClassDef)
    for statement, below in pairwise([*definition.body, None]):
        match statement:
            case ast.AnnAssign(target=ast.Name(id=name), annotation=kind) if (
                "ClassVar" not in ast.unparse(kind)
            ):
                yield name, ast.unparse(kind), _text(below)


def _text(statement: ast.stmt | None) -> str:
    match statement:
        case ast.Expr(value=ast.Constant(value=str(text))):
            return cleandoc(text)
    return ""
