"""YAML text to plain Python data with the line of every key: the only module that knows YAML.

Only the plain part of YAML 1.2 is read: mappings, lists, text, numbers, true, false, null. So
``1e-6`` is a number, while ``on`` and ``12:30`` are text. Anchors, aliases and tags are refused: a
configuration has no use for them, and a few lines of aliases can stand for gigabytes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ruamel.yaml import YAML, events
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from simmpp.common.errors import ConfigError
from simmpp.common.files import refuse_special
from simmpp.common.places import KeyPath

MOST_CHARACTERS = 1_000_000
DEEPEST = 20

_INTEGER = re.compile(r"[-+]?[0-9]{1,30}")
_FLOAT = re.compile(
    r"[-+]?(?:[0-9]{1,30}\.?[0-9]{0,30}|\.[0-9]{1,30})(?:[eE][-+]?[0-9]{1,3})?|[-+]?\.inf|\.nan",
    re.IGNORECASE,
)
_CONSTANTS: dict[str, bool | None] = {"true": True, "false": False, "null": None, "~": None}


@dataclass
class Document:
    """The data of one YAML text, and where each key stands."""

    data: object
    where: str
    """The file's name, for errors."""
    lines: dict[KeyPath, int] = field(default_factory=dict)
    """Line of every key and list entry, by its path."""


def read_yaml(path: Path) -> Document:
    """Read a YAML file.

    Raises ConfigError, one line, if the file can't be read or isn't plain YAML.
    """
    return parse_yaml(yaml_text(path), str(path))


def written(value: object) -> str:
    """A value as YAML has it on one line: ``{cells: 8}``, ``false``; texts are left as they are."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {written(child)}' for key, child in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(written, value))}]"
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return str(value)


def yaml_text(path: Path) -> str:
    """The text of a YAML file.

    Raises ConfigError, one line, if the file can't be read.
    """
    try:
        refuse_special(path)
        with open(path, encoding="utf-8") as file:
            return file.read(MOST_CHARACTERS + 1)
    except UnicodeDecodeError:
        raise ConfigError("expected UTF-8 text", where=str(path)) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise ConfigError(f"can't read the file: {reason}", where=str(path)) from None


def parse_yaml(text: str, where: str = "") -> Document:
    """Parse YAML text; ``where`` names it in errors.

    Raises ConfigError, one line, if the text isn't plain YAML or repeats a key.
    """
    if len(text) > MOST_CHARACTERS:
        raise ConfigError(f"expected at most {MOST_CHARACTERS} characters", where=where)
    document = Document(None, where)
    try:
        _Reader(document, _stream(text)).read()
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = " ".join(str(error.problem or error.context or "unreadable").split())
        line = mark.line + 1 if mark else None
        raise ConfigError(f"broken YAML: {problem}", where=where, line=line) from None
    except YAMLError as error:
        problem = " ".join(str(error).split())
        raise ConfigError(f"broken YAML: {problem}", where=where) from None
    return document


_AWAY = {byte: 0x100000 + byte for byte in range(0xDC80, 0xDD00)}
_BACK = {private: byte for byte, private in _AWAY.items()}
"""Bytes of file names that are no text, as Python has them, and characters that YAML accepts."""


def _stream(text: str) -> Iterator[events.Event]:
    try:
        for event in YAML(typ="safe", pure=True).parse(text.translate(_AWAY)):
            if isinstance(event, events.ScalarEvent):
                event.value = event.value.translate(_BACK)
            yield event
    except YAMLError:
        raise
    except Exception as error:  # the parser trips over some texts, e.g. "\\U99999999"
        raise YAMLError(f"unreadable ({error})") from None


class _Reader:
    """Builds the data of a document from the parser's events."""

    def __init__(self, document: Document, stream: Iterator[events.Event]) -> None:
        self.document, self.stream = document, stream

    def read(self) -> None:
        event = next(self.stream)
        while isinstance(event, events.StreamStartEvent | events.DocumentStartEvent):
            event = next(self.stream)
        if isinstance(event, events.StreamEndEvent):
            return
        self.document.data = self.node(event, ())
        while not isinstance(event, events.StreamEndEvent):
            event = next(self.stream)
            if not isinstance(event, events.DocumentEndEvent | events.StreamEndEvent):
                raise self.error("expected one document", event)

    def node(self, event: events.Event, path: KeyPath) -> object:
        self.document.lines.setdefault(path, _line(event))
        self.refuse_fancy(event)
        if len(path) > DEEPEST:
            raise self.error(f"nested more than {DEEPEST} deep", event)
        if isinstance(event, events.MappingStartEvent):
            return self.mapping(path)
        if isinstance(event, events.SequenceStartEvent):
            return self.sequence(path)
        if isinstance(event, events.ScalarEvent):
            return _plain(event.value) if event.style is None else event.value
        raise self.error("expected a value", event)

    def mapping(self, path: KeyPath) -> dict[str, object]:
        data: dict[str, object] = {}
        while not isinstance(event := next(self.stream), events.MappingEndEvent):
            self.refuse_fancy(event)
            if not isinstance(event, events.ScalarEvent):
                raise self.error("expected a plain key", event)
            key = event.value
            here = (*path, key)
            if key in data:
                first = self.document.lines[here]
                raise self.error(f"duplicate key {key!r}, first on line {first}", event)
            self.document.lines[here] = _line(event)
            data[key] = self.node(next(self.stream), here)
        return data

    def sequence(self, path: KeyPath) -> list[object]:
        data: list[object] = []
        while not isinstance(event := next(self.stream), events.SequenceEndEvent):
            data.append(self.node(event, (*path, len(data))))
        return data

    def refuse_fancy(self, event: events.Event) -> None:
        if isinstance(event, events.AliasEvent) or (
            isinstance(event, events.NodeEvent) and event.anchor
        ):
            raise self.error("anchors and aliases (&name, *name) are not supported", event)
        if tag := getattr(event, "ctag", None):
            raise self.error(f"tags are not supported: {str(tag)!r}", event)

    def error(self, problem: str, event: events.Event) -> ConfigError:
        return ConfigError(problem, where=self.document.where, line=_line(event))


def _line(event: events.Event) -> int:
    return int(event.start_mark.line) + 1


def _plain(text: str) -> object:
    """An unquoted scalar, by the core schema of YAML 1.2 (decimal numbers only)."""
    if text == "":
        return None
    if text.lower() in _CONSTANTS:
        return _CONSTANTS[text.lower()]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _FLOAT.fullmatch(text):
        return float(re.sub(r"\.(?=inf|nan)", "", text.lower()))
    return text
