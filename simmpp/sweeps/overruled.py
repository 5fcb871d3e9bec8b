"""Keys that someone set and that a sweep sets otherwise at every point: refused, not ignored."""

from __future__ import annotations

from simmpp.errors import ConfigError
from simmpp.strict import misplaced
from simmpp.sweeps.axes import SAME, axes_of
from simmpp.sweeps.config import Config, Source

SET = "--set "


def refuse_overruled(config: Config) -> None:
    """Raise ConfigError for a ``--set`` without effect, and for a size of memory given two ways.

    A key of the file that is swept as well is what other commands take, and no mistake.
    """
    if config.source is None:
        return
    swept = _swept_everywhere(config)
    _refuse_set(config.source, swept)
    for pair in SAME:
        for key, other in (pair, pair[::-1]):
            path = tuple(key.split("."))
            if other in swept and _given(config.source.data, path):
                problem = f"expected none: {other} is swept, and says the same in another way"
                raise misplaced(path, problem, config.source.places)


def _swept_everywhere(config: Config) -> list[str]:
    """The keys that each point of the sweep sets; one of named points may be set in some only."""
    axes = axes_of(config.settings.sweep).values()
    return [
        key
        for axis in axes
        for key in axis[0].assignments
        if all(key in choice.assignments for choice in axis)
    ]


def _refuse_set(source: Source, swept: list[str]) -> None:
    wheres = dict.fromkeys(where for where, _ in source.places.values() if where.startswith(SET))
    for where in wheres:
        key = where.removeprefix(SET)
        for name in swept:
            if key == name or key.startswith(f"{name}."):
                raise ConfigError(f"{name!r} is swept; set sweep.{name}", where=where)


def _given(data: object, path: tuple[str, ...]) -> bool:
    for part in path:
        data = data.get(part) if isinstance(data, dict) else None
    return data is not None
