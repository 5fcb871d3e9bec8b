"""The experiments' scripts fit the package: each is read (not run), and says how it is called."""

import runpy
import sys
from pathlib import Path

import pytest

EXPERIMENTS = Path(__file__).parents[2] / "experiments"
SCRIPTS = sorted(EXPERIMENTS.rglob("*.py"))
OPTIONAL = {"mitsuba"}
"""What not every machine can have: there are wheels for x86-64 only."""


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_is_read_and_says_how_it_is_called(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "path", [str(script.parent), *sys.path])  # its neighbours
    try:
        names = runpy.run_path(str(script), run_name="read")
    except ModuleNotFoundError as error:
        if error.name not in OPTIONAL:
            raise
        pytest.skip(f"{error.name} is not installed")
    command = f"python {script.relative_to(EXPERIMENTS.parent)}"
    assert "main" not in names or command in names["__doc__"]


def test_the_table_has_every_script_that_is_called() -> None:
    table = (EXPERIMENTS / "README.md").read_text(encoding="utf-8")
    for script in SCRIPTS:
        command = f"python {script.relative_to(EXPERIMENTS.parent)}"
        is_called = "def main(" in script.read_text(encoding="utf-8")
        assert is_called == (command in table), script
