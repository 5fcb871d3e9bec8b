"""The keys of a configuration, as a list and as a table in Markdown, made from the settings.

``python -m simmpp.config.keys`` prints it; ``python -m simmpp.config.keys configs/README.md`` puts
it between the markers of a file.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.strict import (
    Expect,
    Short,
    expectation,
    fields_of,
    inner_class,
    is_by_name,
    mark_of,
)
from simmpp.common.units import shown
from simmpp.common.yamlfile import written
from simmpp.config.overrides import key_path
from simmpp.config.reading import MACHINE, POLICY, Reading, load_reading
from simmpp.config.settings import DEFAULT_READING, Settings
from simmpp.machine.constants import CopiesConstants
from simmpp.machine.presets import DEFAULT_PRESET, load_preset

REQUIRED = "(required)"
BEGIN, END = "<!-- keys: generated -->", "<!-- /keys -->"
NAME = "NAME"
"""Stands in a key for any name of the user's."""
HEADER = "| key | default | takes | unit | meaning |\n|---|---|---|---|---|\n"


@dataclass(frozen=True)
class Key:
    """One key: what it takes, defaults to and means."""

    name: str
    """With dots, as in ``--set``."""
    default: str
    expect: Expect
    meaning: str
    pointer: str
    """Where the JSON schema of a configuration describes it."""
    of_one_kind: bool
    """It says for one kind of message what another key says for all."""


@cache
def keys() -> dict[str, Key]:
    """All keys by name, those of a mapping below it."""
    return {key.name: key for key in _within(Settings, "", of_one_kind=False)}


def _within(cls: type, prefix: str, *, of_one_kind: bool) -> Iterator[Key]:
    holder = "#" if cls is Settings else f"#/$defs/{cls.__name__}"
    for key, field in fields_of(cls).items():
        inner, expected, short = inner_class(cls, key), expectation(field), mark_of(field, Short)
        if expected is None:
            mapping = "a mapping of the keys below"
            expected = Expect(f"{short.text}, or {mapping}" if short else mapping)
        default = "" if inner else default_of(f"{prefix}{key}", expected, field.get_default())
        default = REQUIRED if field.is_required() else default
        of_kind = of_one_kind or (cls is CopiesConstants and inner is not None)
        meaning, pointer = " ".join((field.description or "").split()), f"{holder}/properties/{key}"
        yield Key(f"{prefix}{key}", default, expected, meaning, pointer, of_kind)
        if inner:
            below = f"{prefix}{key}.{NAME}." if is_by_name(cls, key) else f"{prefix}{key}."
            yield from _within(inner, below, of_one_kind=of_kind)


def default_of(name: str, expected: Expect, value: Any, reading: Reading | None = None) -> str:
    """What a key defaults to; ``value`` is what its field does, where the reading says nothing."""
    reading = reading or load_reading(DEFAULT_READING)
    part, _, key = name.partition(".")
    default = _written(name, expected, value)
    texts = [written(reading.values.get(part, {}).get(key, default))]
    if part == POLICY:
        of_policies = reading.policies.items()
        texts += [
            f"{written(said[key])} for {policy}" for policy, said in of_policies if key in said
        ]
        texts = [text for text in texts if not text.startswith(f"{default} for ")]
    costs = reading.costs.get(DEFAULT_PRESET) if part == MACHINE else None
    if costs and (text := costs.text(key, expected.write)):
        cost = f"{text} ({DEFAULT_PRESET})"
        return default if cost == default else f"{cost[:-1]}, reading {reading.name})"
    return default if texts == [default] else f"{', '.join(texts)} (reading {reading.name})"


def _written(name: str, expected: Expect, value: Any) -> str:
    if value is None:
        preset, (part, _, key) = load_preset(DEFAULT_PRESET), name.partition(".")
        text = part == MACHINE and preset.text(key, expected.write)
        return f"{text} ({DEFAULT_PRESET})" if text else "none"
    if isinstance(value, Fraction):
        return f"{100 * float(value):g}%"
    if isinstance(value, bool):
        return str(value).lower()
    return str(list(value)) if isinstance(value, tuple) else expected.write(value)


def find_keys(name: str) -> list[Key]:
    """A key, and those below it.

    Raises ConfigError for a name that is none, with the nearest.
    """
    if name not in keys():
        for key in keys():
            if key.endswith(f".{name}"):
                raise ConfigError(f"unknown key {shown(name)}: did you mean {key!r}?")
        name = key_path(name)[0]  # of `sweep`, whose keys are others'
    return [key for key in keys().values() if f"{key.name}.".startswith(f"{name}.")]


def listed_keys() -> list[Key]:
    """All but those of single kinds of messages, which take what ``pack`` and ``unpack`` take."""
    return [key for key in keys().values() if not key.of_one_kind]


def key_table() -> str:
    """A Markdown table with one line per key."""
    lines = (
        f"| `{key.name}` | {key.default} | {key.expect.takes} | {key.expect.unit} | {key.meaning} |"
        for key in listed_keys()
    )
    return HEADER + "".join(f"{line}\n" for line in lines)


def with_table(text: str) -> str:
    """``text`` with the present table between its markers.

    Raises ValueError if the markers are missing.
    """
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"expected the markers {BEGIN} and {END}")
    return f"{before}{BEGIN}\n{key_table()}{END}{after}"


def main(arguments: list[str]) -> None:
    """Print the table, or bring the one of a file up to date."""
    if not arguments:
        print(key_table(), end="")
        return
    path = Path(arguments[0])
    path.write_text(with_table(path.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
