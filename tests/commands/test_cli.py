"""The commands as a user meets them: output, files, exit codes."""

import csv
import dataclasses
import gzip
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from calls import begin_in, simmpp

from simmpp.commands.parts.options import window_of
from simmpp.common.errors import ConfigError, ModelError
from simmpp.common.units import format_bytes, format_ps
from simmpp.methods.columns import result_columns

CONFIG = """
scene: tetra:2
reading: plain
picture: {resolution: 12}
processors: 4
memory: {fraction: 0.3}
policy: [ray, concurrent]
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begin_in(tmp_path, monkeypatch)
    Path("c.yaml").write_text(CONFIG)


def test_run_prints_every_policy_with_reference_and_ceiling() -> None:
    done = simmpp("run", "c.yaml")
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert lines[0].startswith("tetra:2: 12 x 12 primary rays")
    assert ["object", "ray", "concurrent", "replicated"] in [line.split() for line in lines]
    (profit,) = [line for line in lines if line.startswith("time profit")]
    assert profit.split()[2] == "1.000"
    assert any(line.startswith("bound: total compute / 4 = ") for line in lines)
    assert done.stderr == ""


def test_run_and_sweep_say_who_wins_before_all_numbers() -> None:
    done = simmpp("run", "c.yaml")
    sentence = done.stdout.splitlines()[3]
    assert sentence.startswith("Send the rays: ray dataflow is fastest; the next, concurrent ")
    done = simmpp("sweep", "c.yaml", "--workers", "1", "--out", "s")
    lines = done.stdout.splitlines()
    assert lines[0] == sentence
    assert lines[-1] == "next: simmpp report s"
    assert simmpp("report", "s").exit_code == 0


@pytest.mark.parametrize(
    ("room", "told"),
    [
        ("memory.fraction=1", "the whole scene, 2.048 kB, fits into every memory: nothing has"),
        ("memory.bytes=2048 B", "the whole scene, 2.048 kB, fits into every memory: nothing has"),
        ("memory.bytes=640 B", "memory.bytes, 640 B, holds resident objects; with rays and fetch"),
        ("memory.bytes=2000 B", "everything fits into memory: at most 1.928 kB on a PE, rays"),
        ("memory.fraction=0.5", None),
    ],
)
def test_run_says_whether_everything_fits(room: str, told: str | None) -> None:
    few = ("picture={resolution: 1, shadows: false}", "processors=2", "machine.ray_bytes=8 B")
    done = simmpp("run", "c.yaml", *(f"--set={key}" for key in (*few, room)))
    notes = done.stdout.split("bound: ")[1].splitlines()
    assert [note for note in notes if "fits into" in note or note.startswith("memory.bytes")] == [
        note for note in notes if told and note.startswith(told)
    ]
    assert not told or told in done.stdout


def test_what_does_not_fit_is_counted() -> None:
    done = simmpp("run", "c.yaml", "--set", "memory.bytes=640 B", "--out", "out")
    with open("out/results.csv", newline="") as file:
        most = {row["policy"]: int(row["peak_bytes"]) for row in csv.DictReader(file)}
    for policy in ("object", "ray", "concurrent"):
        size, times = format_bytes(most[policy]), most[policy] / 640
        assert f"{policy} {size} ({times:.3f} times as much)" in done.stdout


@pytest.mark.parametrize("titles", [("keen", "concurrent"), ("keen", "ray", "concurrent")])
def test_run_names_the_best_classical_dataflow(titles: tuple[str, ...]) -> None:
    keen = "{name: object, label: keen, merge_requests: false}"
    policies = f"policy=[{', '.join(titles).replace('keen', keen)}]"
    done = simmpp("run", "c.yaml", "--set", policies, "--out", "out")
    with open("out/results.csv", newline="") as file:
        times = {row["policy"]: int(row["makespan_ps"]) for row in csv.DictReader(file)}
    assert min(times, key=lambda title: times[title]) == "replicated"
    best = min(titles[:-1], key=lambda title: times[title])
    others = [title for title in titles if title != best]
    line = done.stdout.split("best classical dataflow: ")[1].split("\n\n")[0]
    assert " ".join(line.split()) == "; ".join(
        [
            f"{best}, {format_ps(times[best])}",
            *(f"{title} takes {times[title] / times[best]:.3f} times as long" for title in others),
            *(["ray was not run"] if "ray" not in titles else []),
        ]
    )


def test_run_says_when_a_rule_never_fired() -> None:
    done = simmpp("run", "c.yaml", "--set", "policy={name: concurrent, min_load: 1000000}")
    assert "concurrent: its send rule never fired" in done.stdout


@pytest.mark.parametrize(
    ("processors", "pixels", "told"),
    [
        (12, "rows", None),
        (16, "rows", "4 of 16 PEs start without a ray: the picture has 12 rows"),
        (144, "blocks", None),
        (150, "interleaved", "6 of 150 PEs start without a ray: the picture has 12 x 12 pixels"),
        (18, "{cells: 3}", "2 of 18 PEs start without a ray: the picture has 12 x 12 pixels"),
    ],
)
def test_run_says_how_many_pes_have_no_pixel(
    processors: int, pixels: str, told: str | None
) -> None:
    done = simmpp(
        "run", "c.yaml", "--set", f"processors={processors}", "--set", f"placement.pixels={pixels}"
    )
    lines = [line for line in done.stdout.splitlines() if "start without a ray" in line]
    assert lines == ([told] if told else [])


def test_run_writes_rows_and_record() -> None:
    assert simmpp("run", "c.yaml", "--out", "a/b").exit_code == 0
    with open("a/b/results.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == result_columns()
    assert [row["policy"] for row in rows if row["scene"] == "tetra:2"] == [
        "concurrent", "object", "ray", "replicated",
    ]  # fmt: skip
    assert {row["effective_fraction"] for row in rows if row["policy"] == "replicated"} == {"1.0"}
    record = json.loads(Path("a/b/run.json").read_text())
    assert record["config"]["processors"] == 4
    assert record["machines"][0]["send_startup_ps"] == 10_000_000
    for policy in record["policies"]:
        accounts = zip(*policy["pes"].values(), strict=True)
        assert {sum(account) for account in accounts} == {policy["makespan_ps"]}
    assert [policy["named"] for policy in record["policies"]] == [False, True, True, False]


def test_verify_and_picture() -> None:
    done = simmpp("run", "c.yaml", "--verify", "--picture", "p.png")
    assert done.exit_code == 0, done.output
    verdicts = [line for line in done.stdout.splitlines() if line.startswith("verify ")]
    assert len(verdicts) == 4
    assert all(line.endswith(": the picture of its tests is the same") for line in verdicts)
    assert Path("p.png").read_bytes().startswith(b"\x89PNG")


def test_a_picture_that_differs_fails_and_names_the_pixel(monkeypatch: pytest.MonkeyPatch) -> None:
    from simmpp.engine.simulate import simulate

    def forgetful(*arguments: object, **options: object) -> object:
        result = simulate(*arguments, **options)  # type: ignore[arg-type]
        tests = result.tested_rays, result.tested_objects
        return dataclasses.replace(result, tested_rays=tests[0][:-9], tested_objects=tests[1][:-9])

    monkeypatch.setattr("simmpp.run.point.simulate", forgetful)
    done = simmpp("run", "c.yaml", "--verify")
    assert done.exit_code == 1
    assert "verify ray: differs: pixel (" in done.stdout


def test_a_scene_that_no_ray_hits_is_a_picture_too() -> None:
    view = "v\nfrom 0 0 0\nat 1 0 0\nup 0 0 1\nangle 45\nhither 1\nresolution 8 8\nl 1 1 1\n"
    Path("behind.nff").write_text(view + "f 1 1 1 1 0 0 0 0\ns -9 0 0 1\n")
    done = simmpp("run", "c.yaml", "--set", "scene=behind.nff", "--verify", "--picture", "p.png")
    assert done.exit_code == 0, done.output
    assert "144 rays in all, 0 tests" in done.stdout


def test_two_runs_write_the_same_rows() -> None:
    for out in ("a", "b"):
        simmpp("run", "c.yaml", "--out", out)
    assert Path("a/results.csv").read_bytes() == Path("b/results.csv").read_bytes()


def test_one_pe_needs_no_message_and_no_profit() -> None:
    done = simmpp("run", "c.yaml", "--set", "processors=1", "--set", "policy=ray")
    assert done.exit_code == 0, done.output
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("message profit")]
    assert line.split()[2:] == ["1.000", "1.000", "1.000"]


def test_scene_lists_and_writes_nff() -> None:
    done = simmpp("scene", "tetra:3", "--nff", "t.nff")
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("tetra:3: 64 objects (64 polygons)")
    assert "... and 44 more objects; --objects lists all" in done.stdout
    again = simmpp("scene", "t.nff", "--objects")
    assert len(again.stdout.splitlines()) > 64
    assert "more objects" not in again.stdout


def test_machine_alone_lists_the_machines() -> None:
    lines = simmpp("machine").stdout.splitlines()
    assert [line.split()[0] for line in lines[1:] if not line.startswith(" ")] == [
        "bluegene-l", "cloud", "cpu-cluster", "gpu-cluster", "gpu-node", "t3d", "t3e", "t3e-shmem",
        "tpu-v4", "xe6-hopper"
    ]  # fmt: skip
    assert any(line.startswith("t3e  ") and "300 MHz Alpha 21164" in line for line in lines)


def test_machine_prints_sources() -> None:
    done = simmpp("machine", "t3e")
    assert done.stdout.startswith("t3e: Cray T3E")
    assert "340 MB/s" in done.stdout
    assert "5 us to 20 us" in done.stdout and "ESTIMATE: no PVM figure" in done.stdout


def test_run_says_that_it_does_not_sweep() -> None:
    done = simmpp("run", "c.yaml", "--set", "sweep.processors=[4, 8]")
    assert done.exit_code == 0, done.output
    assert done.stderr == (
        "simmpp: run simulates one point with one seed, 0; the values under 'sweep', more seeds, "
        "tolerance and refine are for simmpp sweep\n"
    )
    assert simmpp("run", "c.yaml", "--set", "seeds=[0, 1]").stderr == done.stderr
    assert simmpp("run", "c.yaml", "--set", "tolerance=2%").stderr == done.stderr


def test_one_of_something_is_no_plural() -> None:
    Path("one.yaml").write_text(CONFIG.replace("memory: {fraction: 0.3}\n", ""))
    few = ("--set", "processors=1", "--set", "memory.bytes=64 MB", "--set", "policy=ray")
    lines = simmpp("run", "one.yaml", *few).stdout.splitlines()
    assert lines[1].startswith("t3e: 1 PE (1 x 1 x 1), memory 64 MB on each (effectively 1)")


@pytest.mark.parametrize("arguments", [("scene", "tetra:5", "--objects"), ("machine", "t3e")])
def test_a_pipe_that_nobody_reads_ends_a_command(arguments: tuple[str, ...]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "simmpp", *arguments], stdout=writer, stderr=subprocess.PIPE
        )
    finally:
        os.close(writer)
    assert (done.returncode, done.stderr) == (141, b"")


def test_a_closed_output_is_no_mistake() -> None:
    code = "import sys; sys.stdout = None; from simmpp.cli import main; main(['machine', 't3e'])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.parametrize(
    ("raised", "code", "line"),
    [
        (ModelError("3 rays left"), 70, "simmpp: this is a bug, please report it: 3 rays left"),
        (OSError(28, "No space left", "o"), 2, "simmpp: error: o: No space left"),
        (KeyboardInterrupt(), 130, "simmpp: interrupted"),
        (MemoryError(), 2, "simmpp: error: out of memory: expected a smaller scene or resolution"),
    ],
)
def test_other_ends(
    monkeypatch: pytest.MonkeyPatch, raised: BaseException, code: int, line: str
) -> None:
    def simulate(*_: object, **__: object) -> None:
        raise raised

    monkeypatch.setattr("simmpp.run.point.simulate", simulate)
    done = simmpp("run", "c.yaml")
    assert done.exit_code == code
    assert done.stderr.splitlines() == [line]


def test_an_interrupted_run_keeps_what_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    from simmpp.engine.simulate import simulate

    def interrupted(*arguments: object, **options: object) -> object:
        if arguments[3].name == "concurrent":  # type: ignore[attr-defined]
            raise KeyboardInterrupt
        return simulate(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr("simmpp.run.point.simulate", interrupted)
    assert simmpp("run", "c.yaml", "--out", "o").exit_code == 130
    lines = Path("o/results.csv").read_text().splitlines()
    assert [line.split(",")[4] for line in lines] == ["policy", "object", "ray"]


def test_run_writes_a_timeline_of_every_policy() -> None:
    assert simmpp("run", "c.yaml", "--timeline", "t.json").exit_code == 0
    events = json.loads(Path("t.json").read_text())["traceEvents"]
    processes = [e["args"]["name"] for e in events if e.get("name") == "process_name"]
    assert processes == ["object", "ray", "concurrent", "replicated"]
    window = ("--timeline", "w.json.gz", "--timeline-window", "0 ms:10 us")
    assert simmpp("run", "c.yaml", *window).exit_code == 0
    cut = json.loads(gzip.decompress(Path("w.json.gz").read_bytes()))["traceEvents"]
    assert max(event.get("ts", 0) for event in cut) <= 10
    assert max(event.get("ts", 0) for event in events) > 10


def test_a_window_may_lie_where_only_a_long_run_comes() -> None:
    assert window_of("11 s:2000 s", "--timeline-window") == (11 * 10**12, 2000 * 10**12)
    with pytest.raises(ConfigError, match=r"value '1e30 s': expected a time .*, at most"):
        window_of("0 ms:1e30 s", "--timeline-window")


def test_run_draws_figures_of_every_policy() -> None:
    command = ("run", "c.yaml", "--set", "policy={name: object, label: 'by o/t'}", "--figures", "f")
    assert simmpp(*command, "--timeline", "t.parquet").exit_code == 0
    names = ("activity", "memory", "pixels", "progress", "torus", "traffic")
    for policy in ("by-o-t", "replicated"):
        for name in names:
            assert Path(f"f/{policy}-{name}.png").read_bytes().startswith(b"\x89PNG")
            assert "</svg>" in Path(f"f/{policy}-{name}.svg").read_text()
    assert len(list(Path("f").iterdir())) == 2 * 2 * len(names)
