"""``simmpp advise``: sentences, files, and what is no question."""

from pathlib import Path

import pytest
from calls import begin_in, refused, simmpp

ASKED = """\
scene: tetra:3
picture: {resolution: 16}
memory: {capacity: 7 kB}
advise: {processors: [2, 4], candidates: [replicated, object, ray]}
"""


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("asked.yaml").write_text(ASKED)


def test_it_says_what_to_use_and_writes_a_table_and_a_page() -> None:
    done = simmpp("advise", "asked.yaml", "--workers", "1", "--out", "advice")
    assert done.exit_code == 0, done.output
    first, *_ = done.stdout.splitlines()
    assert first.startswith("Use ray dataflow on 2 PEs: ")
    assert "    policy: ray\n" in done.stdout
    assert sorted(path.name for path in Path("advice").iterdir()) == [
        ".simmpp",
        "advise.csv",
        "advise.html",
    ]
    page = Path("advice/advise.html").read_text()
    for stem in ("advice-times", "advice-map", "advice-constants"):
        assert f'data-figure="{stem}"' in page


def test_nothing_fits() -> None:
    done = simmpp("advise", "asked.yaml", "--workers", "1", "--set", "memory.capacity=1 kB")
    assert done.exit_code == 1
    assert done.stdout.startswith("Nothing fits into 1 kB a node.")


def test_what_there_is_to_choose_from() -> None:
    done = simmpp("advise", "asked.yaml", "--list", "--set", "advise.candidates=all")
    assert done.exit_code == 0
    assert "ray-islands" in done.stdout and "placement.islands: 4" in done.stdout


def test_a_mistake_has_its_place() -> None:
    Path("asked.yaml").write_text(ASKED.replace("[2, 4]", "[2, 2]"))
    line = refused("advise", "asked.yaml")
    assert line.startswith("asked.yaml:4: advise.processors: value [2, 2]: expected a list")
    Path("asked.yaml").write_text(ASKED.replace("ray]", "rey]"))
    assert "did you mean 'ray'?" in refused("advise", "asked.yaml", "--workers", "1")
    assert refused("advise", "asked.yaml", "--seconds", "0").startswith("--seconds: value")


def test_a_folder_of_a_sweep_is_left_alone() -> None:
    Path("other").mkdir()
    Path("other/timings.csv").write_text("x\n")
    assert refused("advise", "asked.yaml", "--out", "other").startswith("other: holds the files of")
