"""What the guides promise: the README's two commands are marked, scripts and quick commands run."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from simmpp.cli import main

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
OWN = ROOT / "simmpp" / "workload" / "exchange" / "README.md"
GUIDES = [
    README,
    OWN,
    ROOT / "configs" / "README.md",
    ROOT / "experiments" / "motion" / "README.md",
    ROOT / "simmpp" / "sweeps" / "README.md",
]
"""Those with quick commands."""
MOST_LINES = 200
"""Of the README, which is for the first hour."""


def blocks(guide: Path, marker: str, language: str) -> list[str]:
    pattern = rf"^<!-- {marker} -->\n```{language}\n(.*?)^```$"
    return re.findall(pattern, guide.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def run_script(script: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=folder, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def run_command(line: str) -> None:
    program, *arguments = shlex.split(line, comments=True)
    assert program == "simmpp"
    done = CliRunner().invoke(main, arguments)
    assert done.exit_code == 0, f"{line}: {done.output}"


def test_the_readme_has_two_commands_of_one_line() -> None:
    commands = blocks(README, "command", "sh")
    assert len(commands) == 2
    assert all(command.count("\n") == 1 for command in commands)


def test_the_readme_is_read_in_an_hour() -> None:
    assert len(README.read_text(encoding="utf-8").splitlines()) <= MOST_LINES


def test_the_script_runs(tmp_path: Path) -> None:
    (script,) = blocks(README, "script", "python")
    assert len(script.strip().splitlines()) <= 12
    output = run_script(script, tmp_path)
    policies = [line.split(":")[0] for line in output.splitlines()]
    assert policies == ["object", "ray", "concurrent"]
    assert output.startswith("object: time 1.00, messages 1.00")


@pytest.mark.parametrize("guide", GUIDES, ids=lambda guide: guide.parent.name)
def test_the_quick_commands_run(
    guide: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    monkeypatch.chdir(tmp_path)
    lines = "".join(blocks(guide, "quick", "sh")).splitlines()
    assert len(lines) > 1
    for line in lines:
        run_command(line)


def test_every_guide_with_quick_commands_is_run() -> None:
    marked = {
        guide
        for folder in ("simmpp", "configs", "experiments", "tests")
        for guide in (ROOT / folder).rglob("*.md")
        if blocks(guide, "quick", "sh")
    }
    assert marked | {README} == set(GUIDES)


def test_rays_of_ones_own_are_written_and_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (script,) = blocks(OWN, "own", "python")
    (config,) = blocks(OWN, "own", "yaml")
    run_script(script, tmp_path)
    (tmp_path / "own.yaml").write_text(config, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    run_command("simmpp run own.yaml")
