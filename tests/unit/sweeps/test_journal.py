"""The journal of a sweep: what is in it counts, what is torn does not, what differs is refused."""

from pathlib import Path

import pytest

from simmpp.common.errors import ConfigError
from simmpp.sweeps.journal import FILE, Journal, Outcome

IDENTITY = {"versions": {"numpy": "2.0"}, "config": {"processors": 8, "seeds": [0, 1]}}
POINTS = {"points": 64 * "a"}
OUTCOMES = [Outcome("a", {"messages": 3}, 0.5, 0.25), Outcome("b", error="no"), Outcome("c")]


def filled(folder: Path) -> bytes:
    journal = Journal(folder, IDENTITY)
    for outcome in OUTCOMES:
        journal.add(outcome)
    journal.add_trace("d", 1.5)
    journal.close()
    return (folder / FILE).read_bytes()


def test_what_was_added_is_there_again(tmp_path: Path) -> None:
    filled(tmp_path)
    journal = Journal(tmp_path, IDENTITY)
    assert journal.outcomes == {outcome.key: outcome for outcome in OUTCOMES}
    assert journal.trace_s == {"d": 1.5}
    assert [journal.finished(key) for key in "abcx"] == [True, False, True, False]
    assert journal.notices == []


def test_the_last_outcome_of_a_task_counts(tmp_path: Path) -> None:
    filled(tmp_path)
    journal = Journal(tmp_path, IDENTITY)
    journal.add(Outcome("b", {"messages": 1}))
    journal.close()
    assert Journal(tmp_path, IDENTITY).finished("b")


def test_cut_anywhere_it_holds_the_lines_before(tmp_path: Path) -> None:
    """A kill leaves a beginning of the file: any is read, and can be continued."""
    whole = filled(tmp_path)
    for length in range(len(whole) + 1):
        (tmp_path / FILE).write_bytes(whole[:length])
        journal = Journal(tmp_path, IDENTITY)
        complete = whole[:length].count(b"\n")
        assert len(journal.outcomes) == max(0, min(complete - 1, len(OUTCOMES)))
        journal.add(Outcome("new"))
        journal.close()
        again = Journal(tmp_path, IDENTITY)
        assert list(again.outcomes)[-1] == "new"
        again.close()


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        (
            {"versions": {"numpy": "2.1"}, "config": IDENTITY["config"]},
            "versions.numpy is 2.0 there, 2.1 now",
        ),
        (
            {**IDENTITY, "config": {"processors": 9, "seeds": [0, 1]}},
            "config.processors is 8 there, 9 now",
        ),
        (
            {**IDENTITY, **POINTS, "config": {"processors": 9, "seeds": [0, 1]}},
            "config.processors is 8 there, 9 now",
        ),
        ({**IDENTITY, **POINTS}, f"points is not given there, {64 * 'a'} now"),
        (
            {**IDENTITY, "config": {"seeds": [0], "x": 1}},
            "config.processors is 8 there, not given now; config.seeds is [0, 1] there, [0] now; "
            "config.x is not given there, 1 now",
        ),
    ],
)
def test_other_sweeps_are_refused_with_what_differs(
    tmp_path: Path, changed: dict[str, object], problem: str
) -> None:
    before = filled(tmp_path)
    with pytest.raises(ConfigError) as error:
        Journal(tmp_path, changed)
    assert f"holds results of another sweep ({problem})" in str(error.value)
    assert (tmp_path / FILE).read_bytes() == before
    Journal(tmp_path, IDENTITY)


@pytest.mark.parametrize("line", [b"{}", b"3", b"x", b'{"key": 1, "more": 2}', b"\xff"])
def test_a_damaged_line_is_named(tmp_path: Path, line: bytes) -> None:
    lines = filled(tmp_path).splitlines()
    lines[2] = line
    (tmp_path / FILE).write_bytes(b"\n".join(lines) + b"\n")
    with pytest.raises(ConfigError, match=rf"{FILE}:3: damaged"):
        Journal(tmp_path, IDENTITY)


def grown(folder: Path, **more: object) -> list[str]:
    identity = {**IDENTITY, "swept": ["processors"], "names": {"policy a": [1]}, **more}
    Journal(folder, identity).close()
    return (folder / FILE).read_text().splitlines()


def test_a_larger_sweep_is_one_more_line(tmp_path: Path) -> None:
    assert len(grown(tmp_path)) == len(grown(tmp_path)) == 1
    assert len(grown(tmp_path, names={"policy a": [1], "policy b": [2]})) == 2
    assert len(grown(tmp_path, names={"policy b": [2]})) == 2, "what is smaller adds nothing"
    assert len(grown(tmp_path, config={"seeds": [0, 1], "processors": 9})) == 2
    *_, last = grown(tmp_path, swept=["memory.fraction"])
    for part in ('"swept": ["memory.fraction", "processors"]', '"policy a": [1]', '"policy b"'):
        assert part in last
    with pytest.raises(ConfigError, match=r"\(policy b is 2 there, 3 now\)"):
        grown(tmp_path, names={"policy b": [3]})
