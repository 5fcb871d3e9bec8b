"""What the README promises: its two commands are marked, its script runs."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from simmpp.cli import main

README = Path(__file__).parents[2] / "README.md"


def blocks(marker: str, language: str) -> list[str]:
    pattern = rf"^<!-- {marker} -->\n```{language}\n(.*?)^```$"
    return re.findall(pattern, README.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def test_there_are_two_commands_of_one_line() -> None:
    commands = blocks("command", "sh")
    assert len(commands) == 2
    assert all(command.count("\n") == 1 for command in commands)


def test_the_script_runs(tmp_path: Path) -> None:
    (script,) = blocks("script", "python")
    assert len(script.strip().splitlines()) <= 12
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert done.returncode == 0, done.stderr
    policies = [line.split(":")[0] for line in done.stdout.splitlines()]
    assert policies == ["object", "ray", "concurrent"]
    assert done.stdout.startswith("object: time 1.00, messages 1.00")


def test_the_quick_commands_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "configs").symlink_to(README.parent / "configs")
    monkeypatch.chdir(tmp_path)
    lines = "".join(blocks("quick", "sh")).splitlines()
    assert len(lines) > 5
    for line in lines:
        program, *arguments = shlex.split(line, comments=True)
        assert program == "simmpp"
        done = CliRunner().invoke(main, arguments)
        assert done.exit_code == 0, f"{line}: {done.output}"
