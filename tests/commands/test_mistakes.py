"""Every mistake in a call is one line and exit code 2: what was given, what was expected."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

import pytest
from calls import begin_in, refused

from simmpp.machine.presets import preset_names

CONFIG = """
scene: tetra:2
picture: {resolution: 12}
processors: 4
"""
A_NAME = "expected the name of a file or folder"
A_WINDOW = "expected START:END such as '0 ms:5 ms', START before END"
A_FACTOR = "expected NAME=FACTOR, a NAME of startup, packing, object, test"
SOME_SECONDS = "expected a finite number of seconds above 0"
SLOW = "--set machine.test='10 s' --set machine.ray='10 s' --set picture.resolution=700"
MISTAKES = [
    ("run bad.yaml", "bad.yaml:2: processors: value 0: expected an integer from 1 to 65536"),
    (
        "run c.yaml --set processors=0",
        "--set processors: value 0: expected an integer from 1 to 65536",
    ),
    (
        "run c.yaml --set reading=x",
        "--set reading: value 'x': expected mixed or plain, or a file .yaml that exists",
    ),
    ("run none.yaml", "none.yaml: there is no such file; `simmpp init none.yaml` writes one"),
    ("run ''", f"CONFIG: value '': {A_NAME}"),
    ("run c.yaml --engine x", "--engine: value 'x': expected compiled or simpy"),
    (
        "run c.yaml --set method=analytical",
        "--set method: value 'analytical': expected simulate here",
    ),
    ("run c.yaml --set scene=bad.nff", "bad.nff:2: expected a number for the eye, got 'x'"),
    (
        f"run c.yaml --set processors=1 {SLOW}",
        "the simulated time exceeds the clock's 4611686018427387904 ps (53 days): "
        "expected smaller costs or a smaller workload",
    ),
    ("run c.yaml --out ''", f"--out: value '': {A_NAME}"),
    ("run c.yaml --out c.yaml", "--out: value 'c.yaml': can't make it: File exists"),
    ("run c.yaml --picture ''", f"--picture: value '': {A_NAME}"),
    (
        "run c.yaml --picture no/p.png",
        "--picture: value 'no/p.png': expected a file in an existing folder",
    ),
    ("run c.yaml --picture x.jpg", "--picture: value 'x.jpg': expected a file .png"),
    (
        "run c.yaml --picture folder.png",
        "--picture: value 'folder.png': expected a file, it is a folder",
    ),
    (
        "run c.yaml --figures f --set processors=4096",
        "--figures: expected at most 2048 processors: who sent to whom is a matrix",
    ),
    (
        "run c.yaml --timeline t.txt",
        "--timeline: value 't.txt': expected a file .json, .json.gz or .parquet",
    ),
    (
        "run c.yaml --timeline no/t.json",
        "--timeline: value 'no/t.json': expected a file in an existing folder",
    ),
    (
        "run c.yaml --timeline-window '0 ms:5 ms'",
        "--timeline-window: expected --timeline FILE beside it",
    ),
    (
        "run c.yaml --timeline t.json --timeline-window '5 ms'",
        f"--timeline-window: value '5 ms': {A_WINDOW}",
    ),
    (
        "run c.yaml --timeline t.json --timeline-window '2 ms:1 ms'",
        f"--timeline-window: value '2 ms:1 ms': {A_WINDOW}",
    ),
    (
        "run c.yaml --timeline t.json --timeline-window 2:3",
        "--timeline-window: value '2': expected a time such as '12 us'",
    ),
    ("sweep c.yaml --workers 0", "--workers: value '0': expected an integer from 1 to 4096"),
    ("sweep c.yaml --workers 2 --cluster tcp://x:1", "expected --workers or --cluster, got both"),
    ("sweep c.yaml --timeout nan", f"--timeout: value 'nan': {SOME_SECONDS}"),
    ("sweep c.yaml --timeout inf", f"--timeout: value 'inf': {SOME_SECONDS}"),
    ("sweep c.yaml --timeout 0", f"--timeout: value '0': {SOME_SECONDS}"),
    (
        "check c.yaml --baseline b.csv",
        "--baseline: value 'b.csv': expected a file profits.csv "
        "(with results.csv and run.json beside it)",
    ),
    (
        "check c.yaml --baseline b --update --set processors=8",
        "expected --update or --set: a baseline is of CONFIG as it is",
    ),
    ("model c.yaml --imbalance nan", "--imbalance: value 'nan': expected a number from 0 to 1"),
    ("model c.yaml --imbalance 2", "--imbalance: value '2': expected a number from 0 to 1"),
    ("model c.yaml --ratio test=nan", f"--ratio: value 'test=nan': {A_FACTOR}"),
    ("model c.yaml --ratio test=inf", f"--ratio: value 'test=inf': {A_FACTOR}"),
    ("bench c.yaml --seeds 3", "--seeds: value '3': expected an integer from 4 to 10000"),
    ("report none", "DIR: value 'none': expected a folder"),
    ("compare none none", "BEFORE: value 'none': expected a folder"),
    (
        "reproduce --reading x",
        "--reading: value 'x': expected mixed or plain, or a file .yaml that exists",
    ),
    (
        "reproduce --reading plain --reading plain",
        "--reading: two readings are called 'plain': expected different names",
    ),
    (
        "reproduce --reading c.yaml",
        "c.yaml: expected a text description, and what the reading sets",
    ),
    ("reproduce --resolution 0", "--resolution: value '0': expected an integer from 1 to 16384"),
    ("scene tetra:0", "scene.size: value 0: expected an integer from 1 to what the scene can have"),
    ("scene none.nff", "none.nff: can't read the file: No such file or directory"),
    ("scene tetra:1 --preview q.jpg", "--preview: value 'q.jpg': expected a file .png"),
    ("scene tetra:1 --nff q.txt", "--nff: value 'q.txt': expected a file .nff"),
    (
        "workload tetra:2 --export x.csv",
        "--export: value 'x.csv': expected a file .parquet or .npz",
    ),
    ("workload none.npz", "none.npz: there is no such file"),
    ("machine cm5", f"value 'cm5': expected a preset: {', '.join(preset_names())}"),
]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)
    Path("bad.yaml").write_text("scene: tetra:2\nprocessors: 0\n")
    Path("bad.nff").write_text("v\nfrom x\n")
    Path("folder.png").mkdir()


@pytest.mark.parametrize(("call", "message"), MISTAKES, ids=[call for call, _ in MISTAKES])
def test_a_mistake_is_one_line(call: str, message: str) -> None:
    assert refused(*shlex.split(call)) == message


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize(("command", "name"), [("run", "p.yaml"), ("scene", "p.nff")])
def test_a_named_pipe_is_refused(command: str, name: str) -> None:
    os.mkfifo(name)
    assert refused(command, name) == f"{name}: can't read the file: expected a regular file"
