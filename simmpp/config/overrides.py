"""Setting single keys of a configuration's data: ``--set``, its short cuts, values of a sweep."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from simmpp.common.errors import ConfigError
from simmpp.common.places import KeyPath, Place, unknown
from simmpp.common.strict import fields_of, inner_class, is_by_name
from simmpp.common.units import shown
from simmpp.common.yamlfile import parse_yaml
from simmpp.config.axes import SAME, meet
from simmpp.config.settings import Settings, long_policies
from simmpp.config.short_cut import ShortCut
from simmpp.machine.constants import long_test
from simmpp.policy.parameters import DEFAULT_POLICY
from simmpp.scene.view import long_camera
from simmpp.workload.particles.cells import named_cells
from simmpp.workload.sources import long_scene

Places = dict[KeyPath, Place]
"""Where each key was set, by its path."""

_LONG_FORMS: dict[KeyPath, Callable[[object], Any]] = {
    ("scene",): long_scene,
    ("scene", "camera"): long_camera,
    ("scene", "cells"): named_cells,
    ("policy",): long_policies,
    ("machine", "test"): long_test,
}


Override = str | ShortCut
"""``KEY=VALUE`` as ``--set`` takes it, or another option."""
POLICY, SEEDS = "policy", "seeds"
"""Keys that take lists themselves."""
MOST_COUNTED = 100_000
"""Seeds at most by their number: as many as ``max_seeds`` allows."""


def refuse_both(overrides: Iterable[Override]) -> None:
    """Raise ConfigError if ``--set`` has the key of a short cut, too."""
    overrides = list(overrides)
    for cut in (cut for cut in overrides if isinstance(cut, ShortCut)):
        for text in (text for text in overrides if isinstance(text, str)):
            key = " ".join(text.partition("=")[0].split())
            names = [name.strip() for name in key.removeprefix("sweep.").split(",")]
            if any(meet(cut.key, name) or SAME.get(cut.key) == name for name in names):
                raise ConfigError(f"expected {cut.option} or --set {key}, got both")


def override(data: dict[str, Any], assignment: Override, places: Places) -> None:
    """Apply one ``--set KEY=VALUE``, whose value is read as YAML, or a short cut of it."""
    if isinstance(assignment, ShortCut):
        key, value = _meant(assignment, data.get("sweep"))
        set_key(data, key, value, places, (assignment.option, None))
        return
    key, equals, text = assignment.partition("=")
    where = "--set " + " ".join(key.split())
    if not equals or not key:
        raise ConfigError("expected KEY=VALUE, such as processors=8", where=where)
    try:
        value = parse_yaml(text).data
    except ConfigError as error:
        raise ConfigError(error.problem, where=where) from None
    set_key(data, key, value, places, (where, None))


def _meant(cut: ShortCut, axes: object) -> tuple[str, object]:
    """The key and the value that a short cut sets, beside the axes that a sweep has."""
    values = [value for text in cut.texts for value in _listed(cut.option, text)]
    is_axis = isinstance(axes, dict) and cut.key in axes
    if cut.key == POLICY and not (cut.is_swept and is_axis):
        return cut.key, values
    if cut.key == SEEDS and cut.is_swept:
        return cut.key, values if len(values) > 1 else _counted(values[0], cut.option)
    if cut.is_swept:
        return f"sweep.{cut.key}", values
    if len(values) > 1:
        problem = "expected one, as one point is simulated; `simmpp sweep` takes several"
        raise ConfigError(f"value {shown(', '.join(cut.texts))}: {problem}", where=cut.option)
    return cut.key, values if cut.key == SEEDS else values[0]


def _counted(number: object, option: str) -> list[int]:
    """So many seeds, from 0."""
    if type(number) is not int or not 0 < number <= MOST_COUNTED:
        expected = f"expected how many, 1 to {MOST_COUNTED}, or which, such as 0,5"
        raise ConfigError(f"value {shown(number)}: {expected}", where=option)
    return list(range(number))


def _listed(option: str, text: str) -> list[object]:
    """The values of a list as users type it, without its brackets."""
    try:
        values = parse_yaml(f"[{text}]").data
    except ConfigError as error:
        raise ConfigError(error.problem, where=option) from None
    if not isinstance(values, list) or not values:
        raise ConfigError(f"value {shown(text)}: expected at least one value", where=option)
    return values


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
    is_name = False  # the user's own, below which the same keys lie as below any other
    for depth, part in enumerate(parts):
        if is_name:
            is_name = False
            continue
        if parts[:depth] == ("policy", "set") and depth == len(parts) - 1:
            return parts  # whatever the policy's file calls them
        known = sorted(fields_of(model)) if model else []
        if part not in known:
            within = ".".join(parts[:depth])
            problem = unknown(part, known) if known else f"{within!r} has no keys of its own"
            prefix = f"{within}: " if within and known else ""
            raise ConfigError(prefix + problem, where=place[0], line=place[1])
        is_name, model = is_by_name(model, part), inner_class(model, part)
    return parts
