"""The table of keys is made from the code; that of configs/README.md is the present one."""

from pathlib import Path

from simmpp.config.keys import key_table, with_table

README = Path(__file__).parents[3] / "configs" / "README.md"


def test_every_key_says_what_it_takes_and_means() -> None:
    lines = [line.split(" | ") for line in key_table().splitlines()[2:]]
    keys = [line[0].strip("|` ") for line in lines]
    assert len(keys) == len(set(keys))
    assert {"scene.size", "machine.pack.bandwidth", "memory.fraction", "sweep"} <= set(keys)
    assert all(len(line) == 4 and line[2] and line[3].strip(" |") for line in lines)


def test_the_readme_has_the_present_table() -> None:
    text = README.read_text(encoding="utf-8")
    assert with_table(text) == text, "run: python -m simmpp.config.keys configs/README.md"
