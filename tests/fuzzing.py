"""Driving the commands with damaged input: an answer, or one line and exit code 2, and in time."""

from __future__ import annotations

import faulthandler
import os
import signal
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from click.testing import CliRunner, Result
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st

from simmpp.cli import main

DEADLINE_S = 30
"""No example below takes a second; this is a hang."""
LONGEST_LINE = 1000
TRIED = Counter[str]()
"""Examples of the running test by what became of them; the run ends with their sums."""


def examples(few: int) -> settings:
    """``few`` fixed examples, or as many new ones as SIMMPP_TEST_CASES says."""
    asked = os.environ.get("SIMMPP_TEST_CASES")
    return settings(
        max_examples=int(asked or few),
        derandomize=asked is None,
        phases=[Phase.explicit, Phase.reuse, Phase.generate, Phase.shrink],
        report_multiple_bugs=False,
        suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
    )


def answered(*arguments: str) -> Result:
    """A command's result, once it is found to be an answer or a refusal in one line."""
    compiled()
    with alarm(), warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("ignore")
        for kind in (RuntimeWarning, UserWarning):  # what Python shows to everybody
            warnings.simplefilter("always", kind)
        done = CliRunner().invoke(main, arguments)
    assert not seen, [str(warning) for warning in seen]
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    assert done.exit_code in (0, 2), done.output
    if done.exit_code == 2:
        lines = done.stderr.splitlines()
        errors = [line for line in lines if line.startswith("simmpp: error: ")]
        assert errors == lines[-1:], lines  # before it, only notices such as that sweep is not read
        for line in lines:
            assert line.startswith("simmpp: ") and len(line) < LONGEST_LINE, lines
            assert line.isprintable(), lines
    return done


class Hang(Exception):
    """A command did not answer."""


@cache
def compiled() -> None:
    """Compile what commands run, once, so that no example has to wait for it."""
    with tempfile.TemporaryDirectory() as folder:
        file, picture = Path(folder) / "c.yaml", Path(folder) / "p.png"
        file.write_text("scene: tetra:1\npicture: {resolution: 3}\nprocessors: 4")
        done = CliRunner().invoke(main, ["run", str(file), "--picture", str(picture), "--verify"])
        assert done.exit_code == 0, done.output


@contextmanager
def alarm() -> Iterator[None]:
    """Fail after DEADLINE_S; compiled code that does not end is dumped and killed later."""

    def hang(*_: object) -> None:
        raise Hang(f"no answer within {DEADLINE_S} s")

    before = signal.signal(signal.SIGALRM, hang)
    signal.alarm(DEADLINE_S)
    faulthandler.dump_traceback_later(3 * DEADLINE_S, exit=True)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


# --- damage ---


def damaged(data: st.DataObject, content: bytes, most: int = 8) -> bytes:
    """Bytes changed, put in, taken out, and perhaps the end cut off."""
    damage = bytearray(content)
    for _ in range(data.draw(st.integers(0, most))):
        at = data.draw(st.integers(0, max(0, len(damage) - 1)))
        length = data.draw(st.integers(0, 4))
        damage[at : at + length] = data.draw(st.binary(max_size=4))
    return bytes(damage[: data.draw(st.integers(0, len(damage)) | st.just(len(damage)))])


def changed_words(data: st.DataObject, words: Sequence[str], others: st.SearchStrategy[str]) -> str:
    """Words changed, put in, taken out or moved, between blanks and line ends."""
    changed = list(words)
    for _ in range(data.draw(st.integers(1, 5))):
        at = data.draw(st.integers(0, max(0, len(changed) - 1)))
        taken = data.draw(st.integers(0, 3))
        changed[at : at + taken] = data.draw(
            st.lists(others | st.sampled_from(list(words)), max_size=3)
        )
    return " ".join(changed).replace(" \n ", "\n")


# --- YAML, leaves as they are written ---


def written(node: Any) -> str:
    """A tree of mappings (lists of pairs, so that keys may repeat), lists and raw words as YAML."""
    if isinstance(node, tuple):
        return "{" + ", ".join(f"{written(key)}: {written(value)}" for key, value in node) + "}"
    if isinstance(node, list):
        return "[" + ", ".join(map(written, node)) + "]"
    return str(node)


def mutated(data: st.DataObject, node: Any, words: st.SearchStrategy[Any]) -> Any:
    """The tree with one thing changed somewhere: a key, a value, a type, a level."""
    if isinstance(node, tuple | list) and node and data.draw(st.integers(0, 3)):
        at = data.draw(st.integers(0, len(node) - 1))
        items = list(node)
        if isinstance(node, tuple):
            key, value = items[at]
            if data.draw(st.booleans()):
                items[at] = key, mutated(data, value, words)
            else:
                items[at : at + 1] = data.draw(
                    st.sampled_from(
                        [
                            [],
                            [(key, value)] * 2,
                            [(key, [value])],
                            [(key, ((key, value),))],
                            [(data.draw(words), value)],
                            [(written(key) + "x", value)],
                            [(key, value), (data.draw(words), data.draw(words))],
                        ]
                    )
                )
        else:
            items[at] = mutated(data, items[at], words)
        return type(node)(items)
    return data.draw(words)
