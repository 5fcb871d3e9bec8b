"""What a configuration takes from files that it names: a reading, a machine of one's own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from simmpp.common.errors import ConfigError
from simmpp.common.places import KeyPath, Place, misplaced
from simmpp.common.strict import is_line
from simmpp.config.defaults import READING
from simmpp.config.overrides import Places
from simmpp.config.reading import Reading, load_reading
from simmpp.config.settings import DEFAULT_READING, MachineSettings
from simmpp.machine.presets import Preset, load_own

T = TypeVar("T")


def reading_of(data: Mapping[str, Any], places: Places, folder: Path) -> Reading:
    """The reading that a configuration's data names."""
    name = data.get(READING, DEFAULT_READING)
    if not is_line(name):  # which the settings say in their words
        return load_reading(DEFAULT_READING)
    return _loaded(load_reading, name, (READING,), places, folder)


def own_machine(machine: MachineSettings, places: Places, folder: Path) -> Preset | None:
    """The machine of one's own that a configuration names, if it does."""
    if machine.file is None:
        return None
    return _loaded(load_own, machine.file, ("machine", "file"), places, folder)


def _loaded(
    load: Callable[[str, Path], T], name: str, path: KeyPath, places: Places, folder: Path
) -> T:
    """Load what the key at a path names; its mistakes have the place of that key, or their own."""
    try:
        return load(name, folder_of([path], places, folder))
    except ConfigError as error:
        if error.where:
            raise
        raise misplaced(path, error.problem, places) from None


def nearest(places: Places, path: KeyPath) -> Place:
    """Where a key was set, or what holds it."""
    known = (path[:n] for n in range(len(path), -1, -1))
    return next((places[written] for written in known if written in places), ("", None))


def folder_of(paths: Iterable[KeyPath], places: Places, folder: Path) -> Path:
    """Files named in a configuration lie beside it; those named by an option, here."""
    wheres = [nearest(places, path)[0] for path in paths]
    return Path() if any(where.startswith("--") for where in wheres) else folder
