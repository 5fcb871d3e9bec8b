"""The settings that rows were made with: with units, and without what made no difference."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from simmpp.policy.parameters import POLICIES
from simmpp.policy.policy import Policy
from simmpp.policy.reads import settings_used
from simmpp.run import words

APART = ("sweep", "check", "seeds", "policy")
"""What the figures show; policies are told below."""
NEEDS = {"max_seeds": "tolerance"}
"""Keys that say nothing unless another one is set."""
NOTHING: tuple[object, ...] = ({}, [], None, False)
SHARE = re.compile(r"\d+/[1-9]\d*")
"""As records have shares."""


def settings_of(record: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and values of a record's configuration; keys that a sweep changes are left out."""
    config = record.get("config")
    if isinstance(config, dict):
        sweep = config.get("sweep")
        sweep = sweep if isinstance(sweep, dict) else {}
        swept = frozenset(sweep)
        for key, value in config.items():
            is_used = config.get(NEEDS.get(key, key)) not in NOTHING
            if key not in APART and is_used and (text := _said(key, value, swept)):
                yield key, text
        yield from _policies(sweep.get("policy", config.get("policy")))
    if overrides := record.get("set"):
        yield "set", _listed(overrides)


def _said(key: str, value: Any, swept: frozenset[str]) -> str:
    """A value with its unit; of a mapping what there is in it, but what is swept."""
    if key in swept or (key, value) == ("machine.contention", "none"):
        return ""
    if key == "scene" and isinstance(value, dict) and set(value) == {"spd", "size"}:
        return f"{value['spd']}:{value['size']}"
    if isinstance(value, dict):
        parts = {name: _said(f"{key}.{name}", each, swept) for name, each in value.items()}
        return ", ".join(f"{name} {text}" for name, text in parts.items() if text)
    return "" if value is None else _with_unit(key, value)


def _with_unit(key: str, value: Any) -> str:
    """Times, sizes and bandwidths are written with theirs; counts and shares are not."""
    if isinstance(value, str) and SHARE.fullmatch(value):
        return f"{float(Fraction(value)) * 100:.4g} %"
    unit = words.unit_of(key) if isinstance(value, int) and not isinstance(value, bool) else ""
    return f"{_listed(value)} {unit}".strip()


def _policies(entries: Any) -> Iterator[tuple[str, str]]:
    """A line for each, with the settings that make a difference to it."""
    for entry in entries if isinstance(entries, list) else [entries]:
        if isinstance(entry, dict) and isinstance(entry.get("name"), str):
            policy = POLICIES.get(entry["name"])
            used = entry.keys() - {"name", "label"} if policy is None else _used(policy, entry)
            yield "policy", _policy(entry, used)
        elif entry is not None:
            yield "policy", words.policy(entry) if isinstance(entry, str) else _listed(entry)


def _used(policy: Policy, entry: Mapping[str, Any]) -> Iterable[str]:
    return settings_used(policy, steals=entry.get("steal", "none") != "none")


def _policy(entry: Mapping[str, Any], used: Iterable[str]) -> str:
    name = words.policy(entry["name"])
    label = f"{entry['label']} ({name})" if entry.get("label") else name
    given = [key for key in entry if key in set(used)]
    parts = [f"{key} {_with_unit(f'policy.{key}', entry[key])}" for key in given]
    return ": ".join(filter(None, (label, ", ".join(parts))))


def _listed(value: Any) -> str:
    """Short and readable, whatever it is."""
    if isinstance(value, dict):
        return ", ".join(f"{name}: {_listed(each)}" for name, each in value.items())
    if isinstance(value, list):
        return ", ".join(map(_listed, value))
    return value if isinstance(value, str) else json.dumps(value)
