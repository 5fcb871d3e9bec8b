"""The configuration to begin with: what it says holds, and whatever is in it can be set."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from simmpp.common.yamlfile import parse_yaml
from simmpp.config.config import load_config
from simmpp.config.keys import listed_keys
from simmpp.config.settings import Settings
from simmpp.config.starter import CHOICES, starter

LINES = starter().splitlines()
SETTABLE = [n for n, line in enumerate(LINES) if re.match(r" *#\w+:", line)]
EXAMPLES = {key.name.rpartition(".")[2] for key in listed_keys() if key.default in ("none", "{}")}
"""Without a default: what stands there is an example."""


def settings(lines: list[str], folder: Path) -> Settings:
    file = folder / "simmpp.yaml"
    file.write_text("\n".join(lines))
    return load_config(file).settings


def shown(n: int) -> list[str]:
    """The lines with that one taken from behind its #, and the one it is indented below."""
    indent = len(LINES[n]) - len(LINES[n].lstrip())
    tops = [m for m in range(n) if re.match(r"#?\w+:", LINES[m])]
    wanted = {n, *tops[-1:]} if indent == 2 else {n}
    return [re.sub("^( *)#", r"\1", line) if m in wanted else line for m, line in enumerate(LINES)]


def test_it_is_a_configuration(tmp_path: Path) -> None:
    made = settings(LINES, tmp_path)
    assert [policy.name for policy in made.policy] == ["object", "ray", "concurrent"]
    assert max(map(len, LINES)) <= 100


@pytest.mark.parametrize("n", SETTABLE)
def test_each_line_can_be_set_and_says_what_holds(n: int, tmp_path: Path) -> None:
    name, lines = LINES[n].strip(" #").partition(":")[0], shown(n)
    if name == "max_seeds":  # goes with a tolerance
        both = [line.replace("#tolerance: none", "tolerance: 2%") for line in lines]
        assert settings(both, tmp_path).max_seeds == 64
    elif name == "bytes":
        lines = [line for line in lines if not line.startswith("  fraction:")]
        assert settings(lines, tmp_path).memory.bytes == 64_000_000
    elif LINES[n].endswith(":"):
        pass  # with the first line below it
    elif name in EXAMPLES and not LINES[n].endswith(": none"):
        assert settings(lines, tmp_path) != settings(LINES, tmp_path)
    else:
        assert settings(lines, tmp_path) == settings(LINES, tmp_path)


def test_every_key_is_in_it_but_costs_files_and_what_is_no_picture() -> None:
    written = re.sub(r"(?m)^( *)#(?=\w+:)", r"\1", starter())
    data = parse_yaml(written.replace("  fraction: 10%\n", "")).data
    assert isinstance(data, dict)
    names = {key.name for key in listed_keys()}
    tops = {name for name in names if "." not in name}
    assert set(data) == tops - {"radiosity", "particles", "advise"}
    for part in ("picture", "memory", "placement", "check"):
        here = {name.partition(".")[2] for name in names if name.startswith(f"{part}.")}
        assert set(data[part]) == here - {"fraction"}
    assert {f"machine.{name}" for name in data["machine"]} == set(CHOICES)
    policy = {name.removeprefix("policy.") for name in names if name.startswith("policy.")}
    assert set(data["policy"][-1]) == policy - {"file", "set"}
