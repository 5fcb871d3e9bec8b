"""A policy of one's own, from its first line to a sweep."""

from __future__ import annotations

from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp

from simmpp.policy.parameters import POLICIES
from simmpp.policy.view import View


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)


def test_from_a_new_file_to_a_sweep() -> None:
    done = simmpp("policy", "new", "mine")
    assert done.stdout == "wrote mine.py\nnext: simmpp policy check mine.py\n"
    text = Path("mine.py").read_text()
    Path("mine.py").write_text(text.replace("// 2", "// 3"))
    done = simmpp("policy", "check", "mine.py")
    assert done.exit_code == 0, done.output
    for line in ("no ray starves  ok", "one result      ok", "same picture    ok", "ns a call"):
        assert line in done.stdout
    Path("c.yaml").write_text(
        "{scene: tetra:3, picture: {resolution: 12}, processors: 4,"
        " policy: [object, {file: mine.py, set: {patience: 2}}]}"
    )
    done = simmpp("sweep", "c.yaml", "--workers", "1", "--out", "o")
    assert done.exit_code == 0, done.output
    assert "mine" in done.stdout


STARVES = """\
from simmpp.policy import Policy
def send(v):
    return v.load > 10**6
POLICY = Policy("starves", send=send)
"""
OVERFLOWS = """\
from simmpp.policy import Policy
def ask(v):
    v.memory[0] = v.memory[0] * 1000003 + 12345
    return 1
POLICY = Policy("grows", ask=ask)
"""
TRUE_OR_FALSE = """\
from simmpp.policy import Policy
POLICY = Policy("says_yes", send=lambda v: True)
"""


def test_what_is_not_kept_is_told() -> None:
    Path("starves.py").write_text(STARVES)
    done = simmpp("policy", "check", "starves.py")
    assert done.exit_code == 1
    assert "no ray starves  FAILED" in done.stdout
    assert "rays are left and nothing is scheduled" in done.stdout
    Path("yes.py").write_text(TRUE_OR_FALSE)
    done = simmpp("policy", "check", "yes.py")
    assert done.exit_code == 1
    assert "says true or false, which is 1 or 0 rays" in done.stdout
    Path("grows.py").write_text(OVERFLOWS)  # compiled it wraps round
    assert refused("policy", "check", "grows.py").startswith("grows.py:")


def test_lists_name_every_policy_and_every_field() -> None:
    done = simmpp("policy", "list")
    lines = [line.split() for line in done.stdout.splitlines()[1:] if not line.startswith(" ")]
    assert [words[0] for words in lines] == list(POLICIES)
    assert all(policy.source.split()[0] in done.stdout for policy in POLICIES.values())
    done = simmpp("policy", "view")
    named = {line.split()[0] for line in done.stdout.splitlines()}
    assert named >= set(View.__annotations__)


def test_names_that_are_none_are_refused() -> None:
    assert "expected a name of letters" in refused("policy", "new", "a b")
    assert "expected a name of letters" in refused("policy", "new", "object")
    Path("mine.py").write_text("kept")
    assert "is not there yet" in refused("policy", "new", "mine")
    assert Path("mine.py").read_text() == "kept"
    assert "expected the Python file of a policy" in refused("policy", "check", "nix.py")
