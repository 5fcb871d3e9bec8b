"""Several folders as one, whose rows say of which they are: the folder is one more axis."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row
from simmpp.methods.columns import METHOD, PLACE
from simmpp.report.page.folder import Folder
from simmpp.report.page.standing import Warned, warnings_of_each

FOLDER = "folder"
"""The axis; no key of a configuration is called so."""


def together(folders: Mapping[str, Folder], path: Path) -> Folder:
    """The rows of several folders by name, as those of one at ``path``.

    Raises ConfigError for a folder without rows of points, such as that of a bench.
    """
    for name, folder in folders.items():
        if not folder.rows:
            raise ConfigError(f"{name}: there are no rows of points", where=str(folder.path))
    further = dict.fromkeys(column for folder in folders.values() for column in folder.further)
    return Folder(
        path,
        _marked({name: folder.rows for name, folder in folders.items()}),
        (FOLDER, *further),
        profits=_marked({name: _profits(folder) for name, folder in folders.items()}),
        timings=[timing for folder in folders.values() for timing in folder.timings],
        record={
            "points": sum(folder.planned for folder in folders.values()),
            "config": {name: folder.record.get("config", {}) for name, folder in folders.items()},
        },
        parts=folders,
    )


def _marked(tables: Mapping[str, Sequence[Row]]) -> list[Row]:
    """Rows with the name of their folder, and all columns that any of them has."""
    columns = dict.fromkeys(column for rows in tables.values() for row in rows for column in row)
    empty = dict.fromkeys(columns, "")
    return [{**empty, **row, FOLDER: name} for name, rows in tables.items() for row in rows]


def _profits(folder: Folder) -> list[Row]:
    """Those of ``profits.csv`` with the method, which is a key there only where it changes."""
    methods = {row[METHOD] for row in folder.rows}
    method = {METHOD: methods.pop()} if len(methods) == 1 else {}
    return [{**method, **row} for row in folder.profits]


def warnings_of_all(folders: Mapping[str, Folder]) -> list[Warned]:
    """What keeps each of several folders from being whole, and all from being compared."""
    return [*warnings_of_each(folders), *_strangers(folders)]


def _strangers(folders: Mapping[str, Folder]) -> Iterator[Warned]:
    seen: set[tuple[object, ...]] = set()
    further = list(dict.fromkeys(c for folder in folders.values() for c in folder.further))
    for points in (set(_keys(folder.rows, further)) for folder in folders.values()):
        if seen & points:
            return
        seen |= points
    yield Warned("no point is in two of these folders, so there is nothing to compare")


def _keys(rows: Iterable[Row], further: Sequence[str]) -> Iterator[tuple[object, ...]]:
    for row in rows:
        yield tuple(row.get(name, "") for name in (*PLACE, *further, "policy"))
