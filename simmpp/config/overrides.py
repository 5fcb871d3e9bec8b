"""Setting single keys of a configuration's data: ``--set`` and the values of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.places import KeyPath, Place, unknown
from simmpp.common.strict import fields_of, inner_class
from simmpp.common.yamlfile import parse_yaml
from simmpp.config.axes import SAME
from simmpp.config.settings import Settings, long_policies
from simmpp.machine.constants import long_test
from simmpp.policy.parameters import DEFAULT_POLICY
from simmpp.scene.view import long_camera
from simmpp.workload.sources import long_scene

Places = dict[KeyPath, Place]
"""Where each key was set, by its path."""

_LONG_FORMS: dict[KeyPath, Callable[[object], Any]] = {
    ("scene",): long_scene,
    ("scene", "camera"): long_camera,
    ("policy",): long_policies,
    ("machine", "test"): long_test,
}


def override(data: dict[str, Any], assignment: str, places: Places) -> None:
    """Apply one ``--set KEY=VALUE``; the value is read as YAML."""
    key, equals, text = assignment.partition("=")
    where = "--set " + " ".join(key.split())
    if not equals or not key:
        raise ConfigError("expected KEY=VALUE, such as processors=8", where=where)
    try:
        value = parse_yaml(text).data
    except ConfigError as error:
        raise ConfigError(error.problem, where=where) from None
    set_key(data, key, value, places, (where, None))


def set_key(data: dict[str, Any], key: str, value: object, places: Places, place: Place) -> None:
    """Set a dotted key in the data, writing out on the way what short forms stand for."""
    path = key_path(key, place)
    nodes: list[tuple[KeyPath, dict[str, Any]]] = [((), data)]
    for depth, part in enumerate(path[:-1], 1):
        nodes = [child for node in nodes for child in _children(*node, part, path[:depth])]
    for within, node in nodes:
        node[path[-1]] = value
        node.pop(SAME.get(key, "").rpartition(".")[2], None)
        _replace(places, (*within, path[-1]), place)


def _children(
    within: KeyPath, node: dict[str, Any], part: str, path: KeyPath
) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    """The mappings under a key, written out; several where it holds a list of policies."""
    if path == ("policy", "set") and node.get("file") is None:
        return  # only policies of one's own have numbers of their own
    if node.get(part) is None:
        node[part] = {"name": DEFAULT_POLICY} if path == ("policy",) else {}
    elif path in _LONG_FORMS:
        node[part] = _LONG_FORMS[path](node[part])
    here = (*within, part)
    children = enumerate(node[part]) if isinstance(node[part], list) else ()
    yield from (((*here, n), child) for n, child in children if isinstance(child, dict))
    if isinstance(node[part], dict):
        yield here, node[part]


def _replace(places: Places, path: KeyPath, place: Place) -> None:
    """What stood at ``path`` is gone; what stands there now comes from ``place``."""
    for stale in [known for known in places if known[: len(path)] == path]:
        del places[stale]
    for end in range(1, len(path) + 1):
        places.setdefault(path[:end], place)


def key_path(key: str, place: Place = ("", None)) -> tuple[str, ...]:
    """The path of a dotted key, which must exist; keys under ``sweep`` are dotted themselves.

    Raises ConfigError for an unknown one, naming the nearest.
    """
    if key.startswith("sweep."):
        return ("sweep", key.removeprefix("sweep."))
    parts = tuple(key.split("."))
    model: Any = Settings
    for depth, part in enumerate(parts):
        if parts[:depth] == ("policy", "set") and depth == len(parts) - 1:
            return parts  # whatever the policy's file calls them
        known = sorted(fields_of(model)) if model else []
        if part not in known:
            within = ".".join(parts[:depth])
            problem = unknown(part, known) if known else f"{within!r} has no keys of its own"
            prefix = f"{within}: " if within and known else ""
            raise ConfigError(prefix + problem, where=place[0], line=place[1])
        model = inner_class(model, part)
    return parts
