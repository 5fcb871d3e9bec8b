"""Traced paths as a workload: the same whoever traces them, made again from the tests of PEs."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from path_scenes import room

import simmpp
from simmpp.common.errors import ConfigError
from simmpp.engine.record.recording import Recording
from simmpp.engine.simulate import simulate
from simmpp.scene.scene import Light, MeshPart, Scene
from simmpp.workload import room as room_of_rays
from simmpp.workload.check import check
from simmpp.workload.digest import digest_of
from simmpp.workload.exchange.exchange import export_workload, import_workload
from simmpp.workload.picture import Picture
from simmpp.workload.trace import tracer
from simmpp.workload.trace.embree import Intersector
from simmpp.workload.trace.path.radiance import light_of_roots
from simmpp.workload.trace.replay import traced
from simmpp.workload.trace.shading import light, render
from simmpp.workload.trace.tracer import trace
from simmpp.workload.trace.verify import verify
from simmpp.workload.workload import ARRAYS, DIFFUSE, PRIMARY, REFLECTED, REFRACTED, SHADOW

PICTURE = Picture(resolution=(20, 16), render="path", samples=4, depth=6)
LIGHTS = (Light((5, 5, 8), (0.2, 0.2, 0.6)),)


def scene_of() -> Scene:
    """The room with its lamp as a mesh, of more triangles than go without a tree."""
    scene = room(LIGHTS)
    lamp = scene.objects[6].vertices
    grid = [lamp[0] + u * (lamp[1] - lamp[0]) + v * (lamp[3] - lamp[0])
            for v in (0, 0.3, 1) for u in (0, 0.2, 0.6, 1)]  # fmt: skip
    cells = [4 * row + k for row in (0, 1) for k in (0, 1, 2)]
    faces = [face for k in cells for face in ((k, k + 1, k + 5), (k, k + 5, k + 4))]
    mesh = MeshPart(np.array(grid), np.array(faces, np.int32), 3)
    return dataclasses.replace(scene, objects=(*scene.objects[:6], mesh, *scene.objects[7:]))


SCENE = scene_of()
WORKLOAD = trace(SCENE, PICTURE)


def recorded_tests(workload: simmpp.Workload) -> tuple[Any, Any]:
    counts = np.diff(workload.itinerary_offsets)
    rays = np.repeat(np.arange(workload.n_rays, dtype=np.int32), counts)
    return rays, workload.itinerary_objects.copy()


def contents(workload: simmpp.Workload) -> dict[str, bytes]:
    return {name: getattr(workload, name).tobytes() for name in ARRAYS}


class Liar(Intersector):
    """Proposes any object and any triangle that belongs to it, hit or not."""

    def claims(self, origins: Any, directions: Any) -> Any:
        rng = np.random.default_rng(len(origins))
        return self._stands_for[rng.integers(len(self._stands_for), size=len(origins))]


def test_the_workload_is_sound() -> None:
    check(WORKLOAD, "traced")
    n, n0 = WORKLOAD.n_rays, WORKLOAD.n_primaries
    assert (n0, WORKLOAD.samples, WORKLOAD.picture) == (4 * 20 * 16, 4, (16, 20))
    kinds, parents = WORKLOAD.kinds, WORKLOAD.parents
    assert set(kinds) == {PRIMARY, REFLECTED, REFRACTED, DIFFUSE, SHADOW}
    for of_kind in (kinds == SHADOW, (kinds != SHADOW) & (parents >= 0)):
        assert np.bincount(parents[of_kind], minlength=n).max() == 1  # one of each from a hit
    depths = np.ones(n, int)
    for ray in range(n0, n):
        depths[ray] = depths[parents[ray]] + 1
    assert depths.max() == PICTURE.depth


@pytest.mark.parametrize("witness", [Intersector, Liar])
def test_whoever_traces_and_however_many(
    witness: type[Intersector], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One thread and two, batches of any size, true proposals and false ones: the same bytes."""
    assert contents(trace(SCENE, PICTURE, intersector=witness, threads=1)) == contents(WORKLOAD)
    for batch, threads in ((300, 2), (77, 1)):
        monkeypatch.setattr(tracer, "BATCH", batch)
        again = trace(SCENE, PICTURE, intersector=witness, threads=threads)
        assert contents(again) == contents(WORKLOAD)


@pytest.mark.parametrize("suffix", [".parquet", ".npz"])
def test_as_tables_they_are_the_same(tmp_path: Path, suffix: str) -> None:
    export_workload(WORKLOAD, tmp_path / f"a{suffix}")
    again = import_workload(tmp_path / f"a{suffix}")
    assert contents(again) == contents(WORKLOAD)
    assert (again.picture, again.samples) == (WORKLOAD.picture, WORKLOAD.samples)


def test_more_samples_are_more_of_the_same() -> None:
    """The first passes of a picture are those of one with fewer samples."""
    fewer = dataclasses.replace(PICTURE, samples=2)
    workload = trace(SCENE, fewer)
    few, many = (
        light_of_roots(traced(SCENE, picture, rays), rays.hits.copy())
        for picture, rays in ((fewer, workload), (PICTURE, WORKLOAD))
    )
    assert few.tobytes() == many[: len(few)].tobytes()
    other = trace(SCENE, dataclasses.replace(PICTURE, seed=1))
    assert contents(other) != contents(WORKLOAD)


def test_the_tests_of_simulated_pes_make_the_picture() -> None:
    image = render(SCENE, PICTURE, WORKLOAD)
    assert image.shape == (16, 20, 3)
    assert len(np.unique(image)) > 100
    memory = simmpp.Memory(fraction="20%")
    for processors in (2, 5):
        machine = simmpp.make_machine("t3e", processors=processors)
        placement = simmpp.place(WORKLOAD, processors, memory, simmpp.PlacementRules(), seed=0)
        result = simulate(WORKLOAD, machine, placement, "concurrent", record=Recording(tests=True))
        rays, objects = result.tested_rays, result.tested_objects
        assert rays is not None and objects is not None
        assert result.messages > 0
        assert verify(SCENE, PICTURE, WORKLOAD, rays, objects) is None


@pytest.mark.parametrize("kind", [PRIMARY, DIFFUSE, SHADOW])
def test_a_test_that_was_not_made_is_missed(kind: int) -> None:
    rays, objects = recorded_tests(WORKLOAD)
    ray = int(np.flatnonzero((WORKLOAD.kinds == kind) & (WORKLOAD.hits >= 0))[-3])
    kept = ~((rays == ray) & (objects == WORKLOAD.hits[ray]))
    found = verify(SCENE, PICTURE, WORKLOAD, rays[kept], objects[kept])
    assert found is not None
    pixel = int(WORKLOAD.pixels[ray]) % (16 * 20)
    assert (found.row, found.column) == divmod(pixel, 20)


def test_what_a_lamp_sends_is_not_cut_off() -> None:
    bright = light(SCENE, PICTURE, WORKLOAD)
    assert bright.max() > 1
    image = render(SCENE, PICTURE, WORKLOAD)
    assert image.tolist() == np.rint(255 * np.clip(bright, 0, 1)).astype(np.uint8).tolist()


def test_the_digest_is_of_what_chance_depends_on() -> None:
    def repainted(**fields: Any) -> Scene:
        materials = tuple(dataclasses.replace(m, **fields) for m in SCENE.materials)
        return dataclasses.replace(SCENE, materials=materials)

    same = digest_of(SCENE, PICTURE)
    assert digest_of(dataclasses.replace(SCENE, background=(1.0, 1.0, 1.0)), PICTURE) == same
    shares = [{"colour": (0.1,) * 3}, {"kd": 0.1}, {"ks": 0.1}, {"transmittance": 0.1}]
    scenes = [repainted(**fields) for fields in (*shares, {"emission": (1.0,) * 3})]
    settings = [{"samples": 5}, {"depth": 7}, {"roulette": 5}, {"seed": 1}, {"shadows": False}]
    others = [digest_of(scene, PICTURE) for scene in scenes]
    others += [digest_of(SCENE, dataclasses.replace(PICTURE, **some)) for some in settings]
    assert len({same, *others}) == 1 + len(others)


def test_whitteds_rays_may_be_drawn_too() -> None:
    picture = Picture(resolution=8, samples=3)
    workload = trace(SCENE, picture)
    assert (workload.n_primaries, workload.samples) == (3 * 64, 3)
    paths = trace(SCENE, Picture(resolution=8, render="path", samples=3))
    assert (workload.hits[:192] == paths.hits[:192]).all()
    rays, objects = recorded_tests(workload)
    assert verify(SCENE, picture, workload, rays, objects) is None
    assert Picture(render="path").passes == 16


def test_what_does_not_fit_is_refused_before_it_is_traced(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[int] = []
    monkeypatch.setattr(room_of_rays, "_bytes_there_are", lambda: 2**30)
    trace(SCENE, PICTURE, progress=lambda done, known: told.append(done))
    assert told
    told.clear()
    large = dataclasses.replace(PICTURE, resolution=(320, 256))
    with pytest.raises(ConfigError) as caught:
        trace(SCENE, dataclasses.replace(large, samples=20), lambda done, known: told.append(done))
    assert not told
    assert caught.value.problem.startswith("1638400 paths take about 1.")
    assert caught.value.problem.endswith("expected fewer samples, or a lower resolution")
    monkeypatch.setattr(room_of_rays, "_bytes_there_are", lambda: None)
    with pytest.raises(ConfigError, match=r"have about \d+ rays, expected at most 2147483647"):
        trace(SCENE, dataclasses.replace(PICTURE, resolution=4096, samples=64))


def test_a_few_paths_tell_how_many_rays_all_have() -> None:
    picture = dataclasses.replace(PICTURE, resolution=64, samples=8, depth=16)
    whole = trace(SCENE, picture)
    roots = room_of_rays.few_roots(picture.n_roots)
    assert len(np.unique(roots % 64)) == 64  # all columns
    of_few = np.isin(whole.pixels, roots).sum() * picture.n_roots / len(roots)
    assert abs(of_few / whole.n_rays - 1) < 0.1


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"render": "path", "samples": "corners"}, "samples: value 'corners': expected a number"),
        ({"samples": 0}, "samples: value 0: expected centres, corners, or a number per pixel"),
        ({"render": "path", "max_depth": 4}, "max_depth goes with render: whitted; paths have"),
        ({"depth": 4}, "depth goes with render: path"),
        ({"roulette": 1}, "roulette goes with render: path"),
        ({"seed": 1}, "seed goes with a number of samples, or render: path"),
        ({"render": "rays"}, "render: value 'rays': expected "),
    ],
)
def test_settings_that_do_not_go_together(settings: dict[str, Any], line: str) -> None:
    with pytest.raises(ConfigError) as caught:
        Picture(**settings)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)
