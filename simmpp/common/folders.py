"""The folder that a command writes: it holds one kind of results, and one process works there.

``.simmpp`` in it says which kind, and how whoever works there was called; folders that nobody has
marked are known by their files.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from shlex import quote

from filelock import FileLock, Timeout

from simmpp.common.errors import ConfigError
from simmpp.common.files import write_text

MARK, LOCK = ".simmpp", ".simmpp.lock"
"""The lock is gone when nobody works in the folder, or after ``kill -9`` held by nobody."""
PATIENCE_S = 0.2
"""Whoever looks whether others are at work holds the lock as well, for less than that."""
RUN, SWEEP, BENCH, REPRODUCTION = "run", "sweep", "bench", "reproduction"
CHECK, BASELINE, MODEL, ADVICE = "check", "baseline", "model", "advice"
"""Kinds of folders."""
SIGNS = {
    "bench.csv": BENCH,
    "claims.csv": REPRODUCTION,
    "moved.csv": CHECK,
    "timings.csv": SWEEP,
    "results.parquet": SWEEP,
    "run.json:sha256": BASELINE,
    "run.json:policies": RUN,
    "run.json:points": SWEEP,
    "figure2.csv": MODEL,
    "advise.csv": ADVICE,
    "results.csv": "table of others",
}
"""Files, with keys of JSON, by which an unmarked folder is known; the first that is there decides.
"""


@contextmanager
def claimed(folder: Path | None, kind: str) -> Iterator[None]:
    """Make the folder, and let no other process work there meanwhile; None is fine.

    Raises ConfigError, and leaves all as it is, if it holds results of another kind or another
    process works there.
    """
    if folder is None:
        yield
        return
    with held(folder):
        there = kind_of(folder)
        if there not in (None, kind):
            problem = f"holds the files of a {there}: expected those of a {kind}, or none"
            raise ConfigError(problem, where=str(folder))
        if there is None:
            write_text(f"{kind}\n", folder / MARK)
        yield


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """The same for any kind."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / LOCK, timeout=PATIENCE_S)
        lock.acquire()
    except Timeout:
        raise ConfigError("another simmpp is at work here", where=str(folder)) from None
    except OSError as error:
        raise ConfigError(f"can't be written: {error.strerror}", where=str(folder)) from None
    try:
        yield
    finally:
        with suppress(OSError):  # some systems unlink only what nobody has opened
            (folder / LOCK).unlink()  # first: whoever waits for this file then makes another
        lock.release()


def is_at_work(folder: Path) -> bool:
    """Whether a process works in a folder now."""
    try:
        if (folder / LOCK).exists():
            with FileLock(folder / LOCK, timeout=0):
                pass
    except Timeout:
        return True
    except OSError:  # not ours to write, so it can't be said; nothing here depends on it
        return False
    return False


def kind_of(folder: Path) -> str | None:
    """What a folder holds; None if there is nothing that a command would have to do with."""
    names = {path.name for path in folder.iterdir()}
    if not names - {MARK, LOCK}:
        return None  # nothing was finished here
    if MARK in names:
        return _mark(folder)[0]
    return next((kind for sign, kind in SIGNS.items() if sign in names | _keys(folder)), None)


def note_call(folder: Path, call: str) -> None:
    """Note by which command the results here are made, in a folder that is claimed.

    Nothing is noted of the empty text: who calls from Python may have no command.
    """
    noted = f"{Path.cwd()}\n{call}\n" if call else ""  # not that of an earlier, other sweep
    write_text(f"{_mark(folder)[0]}\n{noted}", folder / MARK)


def last_call(folder: Path) -> str:
    """That command, as it can be given from here; empty if nobody noted one."""
    mark = _mark(folder) if (folder / MARK).is_file() else []
    if len(mark) < 3:
        return ""
    _, where, call = mark
    return call if where == str(Path.cwd()) else f"cd {quote(where)} && {call}"


def _mark(folder: Path) -> list[str]:
    """The kind, and if a call was noted where that was, and the call."""
    text = (folder / MARK).read_text(encoding="utf-8", errors="replace")
    return text.strip().split("\n", 2)


def _keys(folder: Path) -> set[str]:
    """``run.json:key`` for each key."""
    try:
        record = json.loads((folder / "run.json").read_bytes())
    except (OSError, ValueError):
        return set()
    return {f"run.json:{key}" for key in record} if isinstance(record, dict) else set()
