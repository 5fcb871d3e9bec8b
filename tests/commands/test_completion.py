"""Completion: every word a new user has to know, at once, and as bash asks for it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import click
import pytest
from calls import begin_in
from click.testing import CliRunner

from simmpp.cli import COMMANDS, main
from simmpp.commands.parts import completion, words
from simmpp.config.keys import keys
from simmpp.machine.presets import preset_names
from simmpp.policy.parameters import POLICIES
from simmpp.scene.spd.generators import GENERATORS


@pytest.fixture(autouse=True, scope="module")
def once() -> None:
    words.words()  # from the cache of all tests; those below have their own


def completed(*asked: str, shell: str = "bash") -> list[str]:
    """What the shell gets; bash has split the words at = and : already."""
    environment = {
        "_SIMMPP_COMPLETE": f"{shell}_complete",
        "COMP_WORDS": "\n".join(("simmpp", *asked)),
        "COMP_CWORD": asked[-1] if shell == "fish" else str(len(asked)),
    }
    done = CliRunner().invoke(main, [], env=environment, prog_name="simmpp")
    assert done.exception is None or isinstance(done.exception, SystemExit), done.output
    return [line.partition(",")[2] for line in done.stdout.splitlines()]


def test_commands_and_options() -> None:
    assert completed("") == list(COMMANDS)
    assert {"--set", "--policy", "--fraction", "--out"} <= set(completed("run", "--"))


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_of_every_command(name: str) -> None:
    real = main.get_command(click.Context(main), name)
    assert real is not None
    light = completion.command(name)
    assert [(p.opts, p.nargs, p.multiple) for p in light.params] == [
        (p.opts, p.nargs, p.multiple) for p in real.params
    ]


def test_commands_in_a_command() -> None:
    assert {"new", "check", "list"} <= set(completed("policy", ""))
    assert completed("policy", "ch") == ["check"]


def test_keys_and_their_values() -> None:
    found = completed("run", "c.yaml", "--set", "m")
    assert {"memory.fraction=", "machine.send_startup=", "max_seeds="} <= set(found)
    assert all(name in keys() for name in words.words()["keys"])
    assert completed("run", "--set", "machine.preset", "=") == preset_names()
    assert completed("run", "--set", "ready_order", "=", "b") == ["breadth-first"]
    assert completed("run", "--set", "policy.merge_requests", "=") == ["true", "false"]
    assert completed("sweep", "--set", "sweep.memory.fr") == ["sweep.memory.fraction="]


def test_scenes_in_parts_as_bash_has_them() -> None:
    sizes = {scene.name: str(scene.default_size) for scene in GENERATORS.values()}
    assert completed("scene", "mou") == [f"mountain:{sizes['mountain']}"]
    assert completed("scene", "mountain", ":") == [sizes["mountain"]]
    assert completed("run", "--set", "scene", "=", "mou") == [f"mountain:{sizes['mountain']}"]
    assert completed("run", "--set", "=", "scene", "=", "mountain", ":") == [sizes["mountain"]]


def test_names() -> None:
    assert completed("run", "--policy", "") == list(POLICIES)
    assert completed("run", "--policy", "ray,c") == ["ray,concurrent", "ray,cost"]
    assert completed("run", "--engine", "=") == ["compiled", "simpy"]
    assert completed("machine", "t") == ["t3d", "t3e", "t3e-shmem", "tpu-v4"]
    assert completed("reading", "") == ["mixed", "plain"]
    assert completed("reproduce", "--reading", "p") == ["plain"]
    assert completed("keys", "see") == ["seeds"]


def test_baselines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for folder in ("b", "a/ci"):
        Path(folder).mkdir(parents=True)
        Path(folder, "profits.csv").touch()
    assert completed("check", "--baseline", "") == ["a/ci/profits.csv", "b/profits.csv"]


@pytest.mark.parametrize("asked", [("run", "c"), ("check", "--baseline", "c"), ("scene", "c")])
def test_files(asked: tuple[str, ...]) -> None:
    assert completed(*asked) == ["c"]  # with the type "file", for the shell to complete


def test_zsh_and_fish_get_whole_words() -> None:
    assert "ready_order=breadth-first" in completed("run", "--set", "ready_order=b", shell="fish")


def test_pressing_a_key_imports_nothing_heavy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin_in(tmp_path, monkeypatch)
    monkeypatch.setenv("_SIMMPP_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "simmpp\nrun\n--set\nmachine.preset\n=")
    monkeypatch.setenv("COMP_CWORD", "4")
    code = (
        "import sys\nsys.argv = ['simmpp']\nfrom simmpp.__main__ import main\n"
        "try: main()\nexcept SystemExit: pass\n"
        "print([n for n in ('numpy', 'numba', 'pydantic', 'rich', 'ruamel') if n in sys.modules])"
    )
    outputs = [
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        for _ in range(2)
    ]
    first, second = (done.stdout.splitlines() for done in outputs)
    assert first[:-1] == second[:-1] == [f"plain,{name}" for name in preset_names()]
    assert first[-1] != "[]" and second[-1] == "[]"


def test_words_are_collected_anew_when_the_package_is_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin_in(tmp_path, monkeypatch)
    file = Path("cache", words.FILE)
    words.words.cache_clear()
    assert words.words() == json.loads(file.read_text())
    for text in (json.dumps({"of": "another", "policies": []}), "{", "[]", ""):
        file.write_text(text)
        words.words.cache_clear()
        assert words.words()["policies"] == list(POLICIES)
        assert json.loads(file.read_text()) == words.words()
