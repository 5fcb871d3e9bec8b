"""What a reading gives to a configuration: only what the configuration does not say itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from simmpp.config.axes import SAME, meet
from simmpp.config.reading import MACHINE, POLICY, Line, Reading
from simmpp.config.settings import Settings, long_policies
from simmpp.policy.file import PolicyFile, policy_of_file
from simmpp.policy.parameters import CEILING, DEFAULT_POLICY, POLICIES, REFERENCE

READING = "reading"
PACKING = "packing"


def filled(data: Mapping[str, Any], reading: Reading) -> dict[str, Any]:
    """A configuration's data, and below it what the reading sets; costs are not among it.

    What is wrong in the data stays as it is, to be told by who checks it.
    """
    return _filled(data, reading)[0]


def lines_used(
    data: Mapping[str, Any],
    settings: Settings,
    reading: Reading,
    preset: str,
    constants: Mapping[str, int],
) -> list[Line]:
    """Those of the reading's lines that say something that the configuration does not.

    ``constants`` are those that it gives to a machine that is this preset, or is based on it.
    """
    used = _filled(data, reading)[1]
    unnamed = {REFERENCE, CEILING} - {policy.name for policy in settings.policy}
    for name in unnamed & reading.policies.keys():  # run to be compared with
        used |= dict.fromkeys(f"{POLICY}.{name}.{key}" for key in reading.policies[name])
    if costs := reading.costs.get(preset):
        left = (costs.written(key) for key in costs.constants.flat() if key not in constants)
        used |= dict.fromkeys(f"{MACHINE}.{preset}.{key}" for key in left)
    return [line for line in reading.lines if any(meet(line.key, key) for key in used)]


def _filled(data: Mapping[str, Any], reading: Reading) -> tuple[dict[str, Any], dict[str, None]]:
    """The data filled, and the keys of the lines that it took."""
    whole, used = {READING: reading.name, **data}, dict[str, None]()
    for part, values in reading.values.items():
        if isinstance(given := data.get(part, {}), dict):
            new = _missing(given, values, part)
            whole[part] = {**given, **new}
            used |= dict.fromkeys(f"{part}.{key}" for key in new)
    policies: list[Any] = []
    for entry in long_policies(data.get(POLICY, {"name": DEFAULT_POLICY})):
        if isinstance(entry, dict) and (name := _like(entry)):
            new = _missing(entry, _that_it_can(entry, reading.policies.get(name, {})), POLICY)
            used |= dict.fromkeys(f"{POLICY}.{name}.{key}" for key in new)
            entry = {**entry, **new}
        policies.append(entry)
    return {**whole, POLICY: policies}, used


def _like(entry: Mapping[str, Any]) -> str:
    """The policy whose values a reading sets hold for this one; empty: none."""
    if (file := entry.get("file")) is not None:
        return policy_of_file(file).like if isinstance(file, PolicyFile) else ""
    name = str(entry.get("name", DEFAULT_POLICY))
    return (name in POLICIES and POLICIES[name].like) or name


def _that_it_can(entry: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """These values, but for how to pack if a policy of one's own can't pack so."""
    file = entry.get("file")
    left_out = isinstance(file, PolicyFile) and values.get(PACKING) not in (
        policy_of_file(file).packings
    )
    return {key: value for key, value in values.items() if key != PACKING or not left_out}


def _missing(given: Mapping[str, Any], values: Mapping[str, Any], part: str) -> dict[str, Any]:
    """The values of the keys that are not given, neither so nor in another way."""
    return {
        key: value
        for key, value in values.items()
        if key not in given
        if SAME.get(f"{part}.{key}", "").removeprefix(f"{part}.") not in given
    }
