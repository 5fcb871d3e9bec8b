"""What of a picture each policy has at a moment of its run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from calls import begin_in, refused, simmpp
from numpy.typing import NDArray
from PIL import Image

CONFIG = """
scene: tetra:2
reading: plain
picture: {resolution: 12, render: path, samples: 3, depth: 4}
processors: 4
memory: {fraction: 0.3}
policy: [object, {name: ray, label: by ray}]
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)


def image(name: str) -> NDArray[np.uint8]:
    with Image.open(name) as opened:
        return np.array(opened)


@pytest.mark.parametrize("settings", [(), ("picture.render=whitted", "picture.samples=corners")])
def test_pictures_of_a_moment(settings: tuple[str, ...]) -> None:
    over = [word for setting in (*settings, "picture.depth=16") for word in ("--set", setting)]
    command = ("run", "c.yaml", *over, "--picture", "p.png", "--until")
    done = simmpp(*command, "1 min")
    assert done.exit_code == 0, done.output
    whole = image("p.png")
    n = 432 if not settings else 169
    assert f"by ray at 60 s: 100.0% of {n} primary rays are finished" in done.output
    for title in ("object", "by-ray", "replicated"):
        assert (image(f"p-{title}.png") == whole).all()
    done = simmpp(*command, "0 ps")
    assert f"object at 0 s: 0.0% of {n} primary rays" in done.output
    assert not image("p-object.png").any()
    done = simmpp(*command, "1 ms")
    some = image("p-object.png")
    assert some.any()
    assert (some != whole).any()


def test_refused() -> None:
    assert (
        refused("run", "c.yaml", "--until", "5 ms") == "--until: expected --picture FILE beside it"
    )
    line = refused("run", "c.yaml", "--picture", "p.png", "--until", "soon")
    assert line.startswith("--until: value 'soon'")
