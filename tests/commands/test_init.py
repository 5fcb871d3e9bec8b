"""simmpp init: a file that runs as it is, and that nothing is lost for."""

from __future__ import annotations

from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)


def test_what_it_writes_runs_by_the_command_it_names() -> None:
    done = simmpp("init")
    assert done.stdout.splitlines() == ["wrote simmpp.yaml", "next: simmpp run simmpp.yaml"]
    small = ("--set", "picture.resolution=8", "--set", "scene=tetra:2", "--processors", "2")
    ran = simmpp("run", "simmpp.yaml", *small)
    assert ran.exit_code == 0, ran.output


def test_what_is_there_stays_unless_it_is_said() -> None:
    Path("mine.yaml").write_text("scene: tetra:2")
    assert refused("init", "mine.yaml") == (
        "FILE: value 'mine.yaml': is there already; --force writes over it"
    )
    assert Path("mine.yaml").read_text() == "scene: tetra:2"
    assert simmpp("init", "mine.yaml", "--force").exit_code == 0
    assert "processors: 64" in Path("mine.yaml").read_text()


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("mine.txt", "value 'mine.txt': expected a file .yaml or .yml"),
        ("no/mine.yaml", "value 'no/mine.yaml': expected a file in an existing folder"),
        ("", "value '': expected the name of a file or folder"),
    ],
)
def test_names_that_are_none(name: str, problem: str) -> None:
    assert refused("init", name) == f"FILE: {problem}"
