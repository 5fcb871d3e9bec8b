"""What a configuration may say, but what does not do what it seems to: a line for each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product

from simmpp.common.places import KeyPath, Place, misplaced
from simmpp.config.axes import keys_of
from simmpp.config.config import Config, point_at
from simmpp.config.settings import long_policies
from simmpp.machine.machine import TORUS
from simmpp.machine.torus import across, default_shape, rounder
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.reads import numbers_read

POLICY = "policy"


def misleading(config: Config, *, is_swept: bool) -> list[str]:
    """The warnings, each once; with ``is_swept`` for all points of the sweep, else for its base."""
    points = _points(config) if is_swept else [config]
    swept = [key for axis in config.axes.values() for key in keys_of(axis)] if is_swept else []
    lines = [*_long_tori(points), *_own_shares(points, config.axes if is_swept else ())]
    lines += _without_capacity(config, points)
    for point in points if POLICY in swept else [config]:
        lines += _ignored(point, swept)
    return list(dict.fromkeys(lines))


def _points(config: Config) -> list[Config]:
    """One for each value of each axis, the first ones of the others."""
    axes = config.axes
    first = dict.fromkeys(axes, 0)
    chosen = [{**first, name: n} for name, axis in axes.items() for n in range(len(axis))]
    return [point_at(config, axes, numbers) for numbers in chosen or [first]]


def _long_tori(points: Sequence[Config]) -> Iterator[str]:
    """Numbers of PEs that make a ring or nearly one, with rounder ones near by."""
    for point in points:
        if point.settings.machine.shape is not None or not (near := rounder(point.processors)):
            continue
        if point.machine_for(point.processors).topology == TORUS:
            shape = default_shape(point.processors)
            others = " and ".join(f"{nb} ({_sizes(default_shape(nb))})" for nb in near)
            yield (
                f"{point.processors} PEs are a torus of {_sizes(shape)}, so messages cross up to "
                f"{across(shape)} links; {others} {'is' if len(near) == 1 else 'are'} rounder"
            )


def _sizes(shape: Sequence[int]) -> str:
    return " x ".join(map(str, shape))


def _own_shares(points: Sequence[Config], axes: Iterable[str]) -> Iterator[str]:
    """Fractions up to what a PE owns, where there are several, and are no room for fetched ones."""
    of_share = (p for p in points if p.memory.bytes is None and not p.memory.fills)
    by_share = [point for point in of_share if point.memory.kept != point.memory.share]
    pairs = [(_sharing(point), point.memory.share) for point in by_share]
    if pairs and {"processors", "memory.fraction"} <= set(axes):  # they are multiplied
        pairs = list(product(*zip(*pairs, strict=True)))
    for sharing in dict.fromkeys(sharing for sharing, _ in pairs):
        n, of_what = sharing
        less = dict.fromkeys(f"{float(x):g}" for of, x in pairs if of == sharing and x * n <= 1)
        if len(less) > 1:
            owned = f"each of {n} PEs{of_what} owns 1/{n} of the scene and holds that"
            yield f"memory.fraction {', '.join(less)} come to the same: {owned}"


def _sharing(point: Config) -> tuple[int, str]:
    """How many PEs own the scene together, and what they are of."""
    islands = point.settings.placement.islands
    return point.processors // islands, f" of each of {islands} islands" if islands > 1 else ""


def _without_capacity(config: Config, points: Sequence[Config]) -> Iterator[str]:
    """What is said of the room on a PE where no PE's memory ends."""
    said = config.kept_source.data.get("memory")
    if any(point.settings.memory.capacity is not None for point in points):
        return
    for key in ("flow", "escape", "buffers", "fetch"):
        if isinstance(said, dict) and key in said:
            told = "without a memory.capacity it decides nothing"
            if key == "fetch":
                told += " (room for objects that are kept is memory.transient)"
            yield str(misplaced(("memory", key), told, config.places))


def _ignored(config: Config, swept: Sequence[str]) -> Iterator[str]:
    """Numbers of policies whose rules do not read them; one --set may serve several policies.

    What is ``swept`` meets policies at other points.
    """
    entries = long_policies(config.kept_source.data.get(POLICY, ()))
    said: dict[tuple[str, Place], list[tuple[KeyPath, PolicyParameters]]] = {}
    for n, (entry, policy) in enumerate(zip(entries, config.settings.policy, strict=False)):
        for key in entry if isinstance(entry, dict) else ():
            if f"{POLICY}.{key}" in swept:
                continue
            path: KeyPath = (POLICY, n, key)
            place = config.places.get(path, ("", n))
            said.setdefault((key, place), []).append((path, policy))
    for (key, (where, _)), given in said.items():
        path, ignoring = given[0][0], [p.title for _, p in given if key in _not_read(p)]
        if len(ignoring) == len(given):
            told = f"{', '.join(ignoring)} {'ignores' if len(ignoring) == 1 else 'ignore'} {key}"
            is_option = where.startswith("--")
            yield f"{where}: {told}" if is_option else str(misplaced(path, told, config.places))


def _not_read(policy: PolicyParameters) -> set[str]:
    """The keys of numbers that decide nothing of what a policy does."""
    rules = policy.rules
    keys = {"min_load", "batch", "ask_at_least"} - set(numbers_read(rules))
    keys |= set() if policy.knows_loads else {"load_info"}
    return keys | (set() if rules.asks else {"merge_requests"})
