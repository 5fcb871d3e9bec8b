"""Cells and particles that make no sense are one line, with the file, the line and the key."""

from __future__ import annotations

from pathlib import Path

import pytest

from simmpp.common.errors import ConfigError
from simmpp.config.config import load_config


def of_slab(keys: str) -> str:
    return f"scene: {{cells: {{preset: slab, {keys}}}}}"


MISTAKES = [
    ("scene: slab\npicture: {}", "picture goes with a scene that is traced, not with scene.cells"),
    ("scene: slab\nradiosity: {}", "radiosity goes with a scene that is traced, not with scene.c"),
    ("scene: tetra\nparticles: {}", "particles goes with scene.cells, not with scene.spd"),
    (of_slab("source: {low: [0, 0, 1.1]}"), "scene.cells: source: value [0.0, 0.0, 1.1] to"),
    (of_slab("source: {low: [0, 1, 0], high: [1, 0, 1]}"), "scene.cells: source: value"),
    (
        of_slab("source: {low: [.nan, 0, 0]}"),
        "scene.cells.source.low: value [nan, 0, 0]: expected three",
    ),
    (of_slab("source: {low: [0, 0, 0], towards: [0, 0, 0]}"), "scene.cells.source: towards is"),
    (
        of_slab("materials: {slab: {albedo: 1.1}}"),
        "scene.cells.materials.slab.albedo: value 1.1: expected a share from 0 to 1",
    ),
    (
        of_slab("materials: {slab: {g: -1}}"),
        "scene.cells.materials.slab.g: value -1: expected a number above -1 and below 1",
    ),
    (
        of_slab("materials: {slab: {sigma_t: -1}}"),
        "scene.cells.materials.slab.sigma_t: value -1: expected a number from 0",
    ),
    (of_slab("materials: {slab: 3}"), "scene.cells.materials.slab: value 3: expected a mapping"),
    (of_slab("materials: [slab]"), "scene.cells.materials: value ['slab']: expected a mapping"),
    (of_slab("materials: {lead: {g: 0}}"), "scene.cells.materials.lead: missing key 'sigma_t'"),
    (of_slab("grid: [9999, 9999, 9999]"), "scene.cells: 9999 x 9999 x 9999 cells: expected at"),
    (of_slab("grid: [1, 1]"), "scene.cells.grid: value [1, 1]: expected three numbers of cells"),
    (of_slab("grid: [1, 1, 0]"), "scene.cells.grid: value 0: expected an integer from 1 to"),
    (of_slab("size: [1, 0, 1]"), "scene.cells: size: value [1.0, 0.0, 1.0]: expected lengths abo"),
    (of_slab("mirrors: [-w]"), "scene.cells.mirrors: value ['-w']: expected a list of sides"),
    (of_slab("boxes: []"), "scene.cells.boxes: value []: expected a list such as"),
    (
        of_slab("boxes: [{material: x, low: [0, 0, 0], high: [1, 1, 1]}]"),
        "scene.cells: boxes: no material 'x': expected slab",
    ),
    (
        of_slab("boxes: [{material: slab, low: [0, 0, 0], high: [1, 1, 1], importance: 3}]"),
        "scene.cells.boxes[0]: importance: value 3: expected a power of two",
    ),
    (
        "scene: {cells: {preset: cube, materials: {matter: {albedo: 1}}}}",
        "scene.cells: mirrors: all sides, and nothing absorbs: expected a way for particles to end",
    ),
    ("scene: {cells: {grid: [1, 1, 1]}}", "scene.cells: missing key 'size'"),
    ("scene: {cells: sphere}", "scene.cells: value 'sphere': expected slab, cube, hohlraum or"),
    ("scene: {cells: 3}", "scene.cells: value 3: expected a mapping"),
    ("scene: {cells: slab, camera: everything}", "scene: camera goes with a scene that is traced"),
    ("scene: slab:65", "scene: value 65: expected an integer from 1 to 64"),
    ("scene: slab\nparticles: {count: 0}", "particles.count: value 0: expected an integer from 1"),
    ("scene: slab\nparticles: {capture: some}", "particles.capture: value 'some': expected analog"),
]


@pytest.mark.parametrize(("text", "problem"), MISTAKES)
def test_a_mistake_is_one_line_with_its_place(tmp_path: Path, text: str, problem: str) -> None:
    file = tmp_path / "c.yaml"
    file.write_text(text)
    with pytest.raises(ConfigError) as error:
        load_config(file)
    line = str(error.value).removeprefix(f"{file}:")
    assert line[0] in "12"
    assert line[3:].startswith(problem)
    assert len(line.splitlines()) == 1


@pytest.mark.parametrize(
    ("override", "expected"),
    [("scene.cells.materials.slab.g=0", 0.0), ("scene.cells.fineness=2", 0.75)],
)
@pytest.mark.parametrize("text", ["scene: slab", "scene: {cells: slab}", of_slab("groups: 1")])
def test_one_key_of_a_preset_is_set(
    tmp_path: Path, text: str, override: str, expected: float
) -> None:
    file = tmp_path / "c.yaml"
    file.write_text(text)
    cells = load_config(file, [override]).settings.scene.cells
    assert cells is not None
    assert cells.materials["slab"].g == expected
    assert cells.materials["slab"].albedo == 0.9
