"""How far the sweep of a folder is: who looks at half of the rows is told so, and how to go on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from shlex import quote
from typing import NamedTuple

from simmpp.common.folders import is_at_work, last_call
from simmpp.common.units import counted
from simmpp.report.page.folder import Folder
from simmpp.run.standing import Standing, recorded_standing

GOES_ON, TRIES_AGAIN, FOLLOWS = "to go on:", "to try again:", "to follow it:"
"""What a command is given for."""
SAME_CALL = "the same call that made the folder"
"""Where nobody noted it."""


class Warned(NamedTuple):
    """What readers have to know before they believe what they see."""

    text: str
    call: str = ""
    """The command that mends it."""
    of: str = ""
    """The name of the folder, where there are several."""

    def __str__(self) -> str:
        """All of it, in one line."""
        return f"{self.of}{': ' if self.of else ''}{self.text} {self.call}".rstrip()


def standing_of(folder: Folder) -> Standing:
    """How far a folder is."""
    n_failed = len(folder.failed)
    by_rows = Standing(folder.planned, len(folder.rows) - n_failed, n_failed, "row")
    return recorded_standing(folder.record) or by_rows


def warnings_of(folder: Folder, *, is_followed: bool = False) -> list[Warned]:
    """What keeps a folder from being whole; a page that follows a sweep says that it runs."""
    return list(_warnings(folder, is_followed or is_at_work(folder.path), is_followed))


def warnings_of_each(folders: Mapping[str, Folder]) -> list[Warned]:
    """The same of several folders, by their names."""
    return [
        warned._replace(of=name)
        for name, folder in folders.items()
        for warned in warnings_of(folder)
    ]


def _warnings(folder: Folder, is_running: bool, is_followed: bool) -> Iterator[Warned]:
    standing, call = standing_of(folder), last_call(folder.path)
    there = f"{standing.counts} are in these tables"  # after kill -9 the journal may have more
    if is_running and not is_followed:
        yield Warned(f"a sweep runs here: {there}; {FOLLOWS}", _follow(folder.path))
    elif not standing.is_whole and not is_running:
        yield Warned(f"interrupted: {there}; {GOES_ON}", call or SAME_CALL)
    if folder.failed:
        text, is_over = _failures(folder), standing.is_whole and not is_running
        yield Warned(f"{text}; {TRIES_AGAIN}", call) if is_over and call else Warned(text)


def _follow(path: Path) -> str:
    return f"simmpp report --live {quote(str(path))}"


def _failures(folder: Folder) -> str:
    errors = dict.fromkeys(str(row["error"]) for row in folder.failed)
    first = next(iter(errors))
    more = f" (and {counted(len(errors) - 1, 'other error')})" if len(errors) > 1 else ""
    return f"{counted(len(folder.failed), 'row')} failed: {first}{more}"
