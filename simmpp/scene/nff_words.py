"""The words of an NFF text, and the line of each for error messages.

The text is split once; a line number is worked out only when something is wrong, so that a
correct file is read at the speed of ``str.split`` and ``float``.
"""

from __future__ import annotations

import math
import re
from typing import NoReturn

from simmpp.common.errors import SceneError
from simmpp.scene.scene import Vector

LARGEST = 1e30
"""Largest magnitude read: products of four such numbers still fit a 64-bit real."""
COMMENT = re.compile(r"#[^\r\n]*")
FOREIGN = re.compile(r"[^\x21-\x7e\s]|_", re.ASCII)
"""Characters of no NFF word; ``float`` would take '1_0' and other scripts' digits."""
OURS = bytes(byte for byte in range(128) if not FOREIGN.match(chr(byte)))


class Words:
    """A cursor over the words of an NFF text.

    Every reading method raises SceneError, with the line, unless it finds what it is named after.
    """

    def __init__(self, text: str, where: str) -> None:
        self.where = where
        self.text = COMMENT.sub("", text)
        # A tenth of the time of a search, which is needed where it finds something only.
        is_ours = not self.text.encode(errors="surrogatepass").translate(None, OURS)
        foreign = None if is_ours else FOREIGN.search(self.text)
        if foreign:
            line = self.text.count("\n", 0, foreign.start()) + 1
            problem = f"not an NFF text: unexpected character {foreign.group()!r}"
            raise SceneError(problem, where=where, line=line)
        self.words = self.text.split()
        self.position = 0

    @property
    def left(self) -> bool:
        """Whether there are words left."""
        return self.position < len(self.words)

    @property
    def last(self) -> str:
        """The word that was read last."""
        return self.words[self.position - 1]

    def word(self, expected: str = "a keyword") -> str:
        """The next word, whatever it is."""
        if not self.left:
            self.fail(f"expected {expected}, but the file ends", at_end=True)
        self.position += 1
        return self.words[self.position - 1]

    def expect(self, keyword: str) -> None:
        """Read a word, which must be this one."""
        got = self.word(f"'{keyword}'")
        if got != keyword:
            self.fail(f"expected '{keyword}', got {self.shown(got)}")

    def skip(self, keyword: str) -> bool:
        """Read that word if it comes next."""
        if self.left and self.words[self.position] == keyword:
            self.position += 1
            return True
        return False

    def next_is_number(self) -> bool:
        """Whether the next word is a number (or tries to be: nan and inf count)."""
        try:
            return self.left and float(self.words[self.position]) is not None
        except ValueError:
            return False

    def numbers(self, n: int, what: str) -> list[float]:
        """The next ``n`` words as finite numbers."""
        words = self.words[self.position : self.position + n]
        try:
            values = list(map(float, words))
        except ValueError:
            values = []
        if len(values) < n or not -LARGEST <= min(values) <= max(values) <= LARGEST:
            self._fail_in(words, what)
        # min and max may step over a nan, which a sum never does.
        if not math.isfinite(sum(values)):
            self._fail_in(words, what)
        self.position += n
        return values

    def number(self, what: str) -> float:
        """Read a number; ``what`` it is stands in the error if it is none, or not finite."""
        return self.numbers(1, what)[0]

    def vector(self, what: str, keyword: str = "") -> Vector:
        """Three finite numbers, after ``keyword`` if one is given."""
        if keyword:
            self.expect(keyword)
        x, y, z = self.numbers(3, what)
        return x, y, z

    def count(self, what: str, low: int, high: int) -> int:
        """A whole number from ``low`` to ``high``."""
        word = self.word(f"a whole number for {what}")
        if not re.fullmatch(r"[+-]?\d{1,18}", word):
            self.fail(f"expected a whole number for {what}, got {self.shown(word)}")
        value = int(word)
        if not low <= value <= high:
            self.fail(f"{what} must be from {low} to {high}, got {value}")
        return value

    @staticmethod
    def shown(word: str) -> str:
        """A word as an error message shows it."""
        return repr(word if len(word) <= 40 else word[:37] + "...")

    def fail(self, problem: str, *, at_end: bool = False) -> NoReturn:
        """Raise SceneError at the line of the word read last, or at the last line."""
        index = len(self.words) if at_end else self.position - 1
        raise SceneError(problem, where=self.where, line=line_of_word(self.text, index))

    def _fail_in(self, words: list[str], what: str) -> NoReturn:
        """Find the first word that is no usable number, and fail there."""
        for word in words:
            self.position += 1
            try:
                value = float(word)
            except ValueError:
                self.fail(f"expected a number for {what}, got {self.shown(word)}")
            if not abs(value) <= LARGEST:
                problem = f"expected a finite number of at most {LARGEST:g} for {what}"
                self.fail(f"{problem}, got {self.shown(word)}")
        self.fail(f"expected a number for {what}, but the file ends", at_end=True)


def line_of_word(text: str, index: int) -> int:
    """Line of the word of that index; the last line that has words if there is none."""
    n_words, last = 0, 1
    for number, line in enumerate(text.split("\n"), start=1):
        words = line.split()
        if words:
            last = number
        n_words += len(words)
        if index < n_words:
            return number
    return last
