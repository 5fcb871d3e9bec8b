"""What ``--help`` promises: quick, whole lines, in the order of work, with examples that parse."""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

import click
import pytest
from calls import simmpp

from simmpp.cli import COMMANDS, main
from simmpp.commands.parts.options import ENGINES
from simmpp.engine import simulate

REPOSITORY = Path(__file__).parents[2]
CONTEXT = click.Context(main)


def command(name: str) -> click.Command:
    command = main.get_command(CONTEXT, name)
    assert command is not None
    return command


def loaded(code: str) -> list[str]:
    """Which of the heavy modules a program has imported at its end."""
    heavy = ("numpy", "numba", "pydantic", "pint", "embreex", "rich")
    code += f"\nimport sys; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names: list[str] = eval(done.stdout.splitlines()[-1])
    return names


def test_help_imports_nothing_heavy() -> None:
    code = "from simmpp.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass"
    assert loaded(code) == []


def test_sweep_begins_its_workers_before_anything_heavy_is_imported() -> None:
    assert loaded("import simmpp.commands.sweep") == []


def test_help_fits_80_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    lines = simmpp("--help").stdout.splitlines()
    assert max(map(len, lines)) < 80
    assert lines[-len(COMMANDS) :] == [f"  {n:9}  {text}" for n, text in COMMANDS.items()]


def test_commands_are_in_the_order_of_work() -> None:
    assert main.list_commands(CONTEXT) == list(COMMANDS)
    assert list(COMMANDS)[:4] == ["init", "run", "sweep", "report"]


@pytest.mark.parametrize("name", COMMANDS)
def test_the_table_says_what_the_help_of_a_command_says(name: str) -> None:
    assert command(name).name == name
    assert (command(name).help or "").splitlines()[0] == COMMANDS[name]


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_parse(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(REPOSITORY)
    lines = [line.strip() for line in (command(name).epilog or "").splitlines()[2:]]
    assert lines
    for line in lines:
        program, named, *arguments = shlex.split(line)
        assert (program, named) == ("simmpp", name)
        with command(name).make_context(name, arguments, parent=CONTEXT) as context:
            config = context.params.get("config_path")
            assert config is None or config.is_file()
    assert all(line in simmpp(name, "--help").stdout for line in lines)


def test_a_command_that_there_is_not_is_told_with_the_nearest() -> None:
    done = simmpp("rnu", "c.yaml")
    assert done.exit_code == 2
    assert done.stderr.splitlines()[-1] == "Error: No such command 'rnu'. Did you mean 'run'?"
    assert "Did you mean" not in simmpp("qqqq").stderr


def test_engines_are_those_that_there_are() -> None:
    assert set(ENGINES) == set(simulate.ENGINES)


def test_version() -> None:
    assert simmpp("--version").stdout.startswith("simmpp, version ")
