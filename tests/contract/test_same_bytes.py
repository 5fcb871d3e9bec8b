"""Two runs give the same bytes, whatever the hash seed of Python and whichever process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from simmpp.common.cache import cache_folder

CONFIG = """\
scene: {spd: rings, size: 1}
picture: {resolution: 12}
processors: 12
memory: {fraction: 0.2, residents: random, transient: 2}
placement: {owners: random, pixels: random}
policy: [object, ray, {name: concurrent, min_load: 2, batch: 8, ask_at_least: 2}]
"""


def run_once(folder: Path, config: Path, hash_seed: str) -> tuple[bytes, bytes, object]:
    """Rows, picture and record of a run in a process of its own."""
    folder.mkdir()
    picture = folder / "picture.png"
    command = ["run", str(config), "--out", str(folder), "--picture", str(picture)]
    environment = os.environ | {"PYTHONHASHSEED": hash_seed, "SIMMPP_CACHE": str(folder / "cache")}
    environment.setdefault("NUMBA_CACHE_DIR", str(cache_folder() / "compiled"))
    program = [sys.executable, "-c", "from simmpp.cli import main; main()"]
    subprocess.run([*program, *command], env=environment, check=True, stdout=subprocess.DEVNULL)
    record = json.loads((folder / "run.json").read_text())
    for policy in record["policies"]:
        del policy["wall_s"]
    return (folder / "results.csv").read_bytes(), picture.read_bytes(), record


def test_rows_picture_and_record_are_the_same(tmp_path: Path) -> None:
    config = tmp_path / "config.yaml"
    config.write_text(CONFIG)
    first, again = (run_once(tmp_path / seed, config, seed) for seed in ("1", "4711"))
    assert first == again
