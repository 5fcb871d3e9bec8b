"""Sizes that nobody has the time or memory for are refused at once, in one line."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

import simmpp
from simmpp.cli import main
from simmpp.common.errors import ConfigError
from simmpp.config.config import load_config
from simmpp.sweeps.grid import MOST_POINTS, grid
from simmpp.workload import room


def test_pictures_that_no_memory_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = simmpp.load_scene("tetra:1")
    monkeypatch.setattr(room, "BYTES_PER_RAY", 10**12)  # as if memory were that much smaller
    with pytest.raises(ConfigError, match=r"tetra:1: 4096 primary rays take 4096 TB, there are"):
        simmpp.trace(scene, simmpp.Picture(resolution=64))
    with pytest.raises(ConfigError, match="resolution: value 1073741824: expected an integer from"):
        simmpp.Picture(resolution=2**30)
    beyond = simmpp.Picture()
    object.__setattr__(beyond, "resolution", 2**30)  # past its own check
    with pytest.raises(ConfigError, match="more than 2147483647 rays"):
        simmpp.trace(scene, beyond)


def test_sweeps_that_never_end(tmp_path: Path) -> None:
    axes = "\n".join(
        f"  {key}: [{', '.join(f'{n} us' for n in range(100))}]"
        for key in ("machine.latency", "machine.ray", "machine.probe", "machine.test.mesh")
    )
    (tmp_path / "c.yaml").write_text(f"scene: tetra:1\nsweep:\n{axes}\n")
    with pytest.raises(ConfigError, match="sweep: 100000000 combinations with 1 seed each"):
        grid(load_config(tmp_path / "c.yaml"))
    done = CliRunner().invoke(
        main, ["sweep", str(tmp_path / "c.yaml"), "--out", str(tmp_path / "o")]
    )
    assert done.exit_code == 2
    assert f"expected at most {MOST_POINTS} points" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize(
    "key",
    [
        "processors=65537", "picture.resolution=16385", "picture.max_depth=101",
        "machine.quantum=2147483648", "memory.bytes=1e18 B", "memory.transient=2147483648",
        "placement.pixels={cells: 2147483648}", "memory.transient=1e30%",
        "machine.latency=11 s",
        "machine.link_bandwidth=1e16 B/s", "machine.link_bandwidth=999 B/s", "policy.batch=0",
        "seeds=[9223372036854775808]", "scene=balls:20", "scene=tetra:15", "scene=mountain:40",
        "scene=gears:1000", "scene=rings:100000", "scene=jacks:30", "scene=tree:99",
        "scene=lattice:999", "machine.shape=[-64, -1, 1]", "machine.shape=[1, 1, 65536]",
    ],
)  # fmt: skip
def test_keys_beyond_their_range(tmp_path: Path, key: str) -> None:
    (tmp_path / "c.yaml").write_text("scene: tetra:1\n")
    with pytest.raises(ConfigError) as refused:
        load_config(tmp_path / "c.yaml", [key])
    assert "expected" in str(refused.value) or "must be" in str(refused.value)
    assert "\n" not in str(refused.value)
