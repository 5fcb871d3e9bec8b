"""The text of a mesh file: its lines, names and numbers, at the speed of ``split`` and ``float``.

Text is decoded byte by byte, as Latin-1: numbers and keywords are ASCII in every encoding, and
names are taken for UTF-8 if they can be that.
"""

from __future__ import annotations

import codecs
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.scene.cut import Indices
from simmpp.scene.scene import Floats

Line = Callable[[int], int | None]
"""The line of the word, or element, of that index; None in a binary file."""
LONGEST_SHOWN = 40


@dataclass(frozen=True)
class Source:
    """A file that is being read, and the format that it is read as."""

    file: Path
    kind: str

    def error(self, problem: str, line: int | None = None) -> SceneError:
        """What to raise for a file that is not of its format."""
        problem = f"not a readable {self.kind} mesh: {problem}"
        return SceneError(problem, where=str(self.file), line=line)


def decoded(data: bytes) -> str:
    """The text of a file, a character for each byte; line ends are made ``\\n``."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        data = data.decode("utf-16", errors="replace").encode()
    text = data.removeprefix(codecs.BOM_UTF8).decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def named(text: str) -> str:
    """A name within decoded text: UTF-8 if it can be that, else Latin-1; blanks made one."""
    name = " ".join(text.split())
    try:
        return name.encode("latin-1").decode("utf-8")
    except UnicodeDecodeError:
        return name


def shown(word: str) -> str:
    """A word as a message shows it."""
    name = named(word)
    return repr(name if len(name) <= LONGEST_SHOWN else name[: LONGEST_SHOWN - 3] + "...")


def floats(words: Sequence[str], source: Source, line: Line) -> Floats:
    """The words as float64; an error names the first that is no number."""
    return _numbers(words, _floats, "a number", source, line)


def integers(words: Sequence[str], source: Source, line: Line) -> Indices:
    """The words as int64; an error names the first that is no whole number."""
    return _numbers(words, _integers, "a whole number", source, line)


def _floats(words: Sequence[str]) -> Floats:
    return np.fromiter(map(float, words), np.float64, len(words))


def _integers(words: Sequence[str]) -> Indices:
    return np.fromiter(map(int, words), np.int64, len(words))


def _numbers(
    words: Sequence[str],
    read: Callable[[Sequence[str]], Any],
    what: str,
    source: Source,
    line: Line,
) -> Any:
    try:
        if "_" not in "".join(words):  # Python takes 1_0 for ten
            return read(words)
    except (ValueError, OverflowError):
        pass
    for index, word in enumerate(words):
        try:
            if "_" in word:
                raise ValueError
            read([word])
        except (ValueError, OverflowError):
            problem = f"expected {what}, got {shown(word)}"
            raise source.error(problem, line(index)) from None
    raise AssertionError("each word is a number, and all of them are not")
