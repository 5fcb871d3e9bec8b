"""Workloads on disk: what is read back is what was traced, or it is noticed and traced again."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.common.errors import WorkloadError
from simmpp.scene.scene import Cone, Light, MeshPart, Polygon, Sphere
from simmpp.workload.cache import store
from simmpp.workload.cache.store import load, save, workload_for
from simmpp.workload.digest import digest_of
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import Workload

SCENE = load_scene("mountain:2")
PICTURE = Picture(resolution=12)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    monkeypatch.setenv("SIMMPP_CACHE", str(folder))
    return folder


def same(one: Workload, other: Workload) -> bool:
    return all(
        np.array_equal(getattr(one, field.name), getattr(other, field.name))
        for field in dataclasses.fields(Workload)
    )


def the_file(cache: Path) -> Path:
    (path,) = cache.glob("*.arrow")
    return path


def test_the_second_time_nothing_is_traced(cache, monkeypatch) -> None:
    first = workload_for(SCENE, PICTURE)
    monkeypatch.setattr(store, "trace", lambda *_: pytest.fail("traced again"))
    second = workload_for(dataclasses.replace(SCENE, name="another name"), PICTURE)
    assert second.name == "another name"
    assert same(dataclasses.replace(second, name=first.name), first)
    assert not second.kinds.flags.writeable
    assert [path.name for path in cache.iterdir()] == [f"{first.digest}.arrow"]


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def empty(path: Path) -> None:
    path.write_bytes(b"")


def flip_a_byte(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def foreign(path: Path) -> None:
    with open(path, "wb") as file:
        np.savez(file, something=np.arange(3))


def of_other_columns(path: Path) -> None:
    write(pa.RecordBatch.from_pydict({"something": [[1, 2, 3]]}), path)


def write(row: pa.RecordBatch, path: Path) -> None:
    with pa.OSFile(str(path), "wb") as file, pa.ipc.new_file(file, row.schema) as writer:
        writer.write_batch(row)


def of_another_scene(path: Path) -> None:
    data = workload_for(load_scene("mountain:1"), PICTURE)
    save(data, path)


@pytest.mark.parametrize(
    "damage", [truncate, empty, flip_a_byte, foreign, of_other_columns, of_another_scene]
)
def test_a_damaged_file_is_noticed_and_made_again(cache, damage) -> None:
    first = workload_for(SCENE, PICTURE)
    path = the_file(cache)
    damage(path)
    told: list[str] = []
    assert same(workload_for(SCENE, PICTURE, notice=told.append), first)
    assert len(told) == 1 and str(path) in told[0] and "\n" not in told[0]
    assert same(load(path), first)


def test_a_sound_file_of_changed_arrays_is_noticed(tmp_path) -> None:
    path = tmp_path / "one.arrow"
    save(workload_for(SCENE, PICTURE), path)
    with pa.OSFile(str(path)) as file:
        row = pa.ipc.open_file(file).get_batch(0)
    distances = pa.array([[2 * distance for distance in row["hit_distances"][0].as_py()]])
    column = row.schema.get_field_index("hit_distances")
    changed = row.set_column(column, row.schema.field(column), distances.cast(row[column].type))
    write(changed, path)
    with pytest.raises(WorkloadError, match="checksum"):
        load(path)


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("workload") / "sound.arrow"
    save(trace(load_scene("tetra:1"), Picture(resolution=4)), path)
    return path


@given(st.data())
def test_damage_is_noticed_or_harmless(sound: Path, data: st.DataObject) -> None:
    """Never other rays, never anything but a WorkloadError."""
    content = bytearray(sound.read_bytes())
    place = data.draw(st.integers(0, len(content) - 1))
    if data.draw(st.booleans()):
        content[place] ^= data.draw(st.integers(1, 255))
    else:
        del content[place:]
    path = sound.with_name("damaged.arrow")
    path.unlink(missing_ok=True)  # pages of the one before may still be in use
    path.write_bytes(content)
    try:
        assert same(load(path), load(sound))
    except WorkloadError as error:
        assert "\n" not in str(error)


def test_equal_workloads_make_equal_files(sound: Path) -> None:
    again = sound.with_name("again.arrow")
    save(load(sound), again)
    assert again.read_bytes() == sound.read_bytes()


def test_arrays_are_pages_of_the_file(sound: Path) -> None:
    workload = load(sound)
    for field in dataclasses.fields(Workload):
        value = getattr(workload, field.name)
        if isinstance(value, np.ndarray):
            assert value.flags.aligned and not value.flags.writeable
            assert not value.flags.owndata


def test_a_cache_that_cannot_be_written_costs_a_notice(tmp_path, monkeypatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SIMMPP_CACHE", str(tmp_path / "file" / "below"))
    told: list[str] = []
    assert workload_for(SCENE, PICTURE, notice=told.append).n_rays > 144
    assert len(told) == 1 and "not cached" in told[0]
    with pytest.warns(UserWarning, match="not cached"):
        workload_for(SCENE, PICTURE)


def test_a_failed_write_leaves_no_file(tmp_path, monkeypatch) -> None:
    def full(*_, **__):
        raise OSError("no space left")

    workload = workload_for(SCENE, PICTURE)
    monkeypatch.setattr(store.pa.ipc, "new_file", full)
    with pytest.raises(OSError, match="no space"):
        save(workload, tmp_path / "one.arrow")
    assert not list(tmp_path.glob("one*"))


@pytest.mark.parametrize(
    "name, change, problem",
    [
        ("parents", lambda a: a + 1, "primary ray has a parent"),
        ("child_offsets", lambda a: a[::-1], "child_offsets"),
        ("itinerary_offsets", lambda a: a[:-1], "itinerary_offsets has"),
        ("itinerary_objects", lambda a: a + 1000, "itinerary_objects names"),
        ("hits", lambda a: np.where(a >= 0, (a + 1) % 36, a), "not in its itinerary"),
        ("hits", lambda a: np.full_like(a, -1), "has children"),
        ("hit_distances", lambda a: -a, "disagree"),
        ("kinds", lambda a: a + 1, "kinds of rays"),
        ("pixels", lambda a: a[::-1], "pixel"),
        ("object_bytes", lambda a: a.astype(np.int32), "object_bytes is int32"),
        ("object_centroids", lambda a: a[:, :2], "columns"),
        ("object_triangles", lambda a: a[:-1], "object_triangles has"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(tmp_path, name, change, problem) -> None:
    workload = workload_for(SCENE, PICTURE)
    path = tmp_path / "bad.arrow"
    save(dataclasses.replace(workload, **{name: change(getattr(workload, name).copy())}), path)
    with pytest.raises(WorkloadError, match=problem):
        load(path)


def test_a_missing_file_is_one_line(tmp_path) -> None:
    with pytest.raises(WorkloadError, match="No such file"):
        load(tmp_path / "none.arrow")


def test_the_digest_is_of_what_makes_a_workload() -> None:
    def changed(**fields):
        return digest_of(dataclasses.replace(SCENE, **fields), PICTURE)

    same_digest = digest_of(SCENE, PICTURE)
    red = tuple(dataclasses.replace(m, colour=(1.0, 0.0, 0.0)) for m in SCENE.materials)
    assert changed(name="x", background=(1.0, 1.0, 1.0), materials=red) == same_digest
    thin = tuple(dataclasses.replace(m, ior=1.1) for m in SCENE.materials)
    shiny = tuple(dataclasses.replace(m, ks=0.5) for m in SCENE.materials)
    others = [
        changed(objects=SCENE.objects[1:]),
        changed(objects=SCENE.objects[::-1]),
        changed(lights=(Light((1.0, 2.0, 3.0)),)),
        changed(camera=dataclasses.replace(SCENE.camera, angle_degrees=44)),
        changed(materials=thin),
        changed(materials=shiny),
        digest_of(SCENE, dataclasses.replace(PICTURE, max_depth=4)),
        digest_of(SCENE, dataclasses.replace(PICTURE, samples="corners")),
    ]
    assert len({same_digest, *others}) == 1 + len(others)


def test_the_digest_is_of_all_geometry() -> None:
    corners = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 2, 0), (2, 2, 2)])
    faces = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    made = [
        (Sphere((0.0, 1.0, 2.0), 3.0),),
        (Sphere((0.0, 1.0, 2.0), 4.0),),
        (Cone((0.0, 0.0, 0.0), 1.0, (0.0, 0.0, 1.0), 2.0),),
        (Cone((0.0, 0.0, 0.0), 2.0, (0.0, 0.0, 1.0), 1.0),),
        (Polygon(corners),),
        (Polygon(corners[:3]), Polygon(corners[3:])),
        (Polygon(corners[::-1]),),
        (MeshPart(corners, faces),),
        (MeshPart(corners, faces[::-1]),),
        (MeshPart(corners + 1, faces),),
        (MeshPart(corners[:4], faces),),
        (MeshPart(corners[:4], faces), MeshPart(corners[:4], faces[:1])),
        (MeshPart(corners[:4], faces[:1]), MeshPart(corners[:4], faces)),
    ]
    digests = [digest_of(dataclasses.replace(SCENE, objects=each), PICTURE) for each in made]
    assert len(set(digests)) == len(made)
    wide = (MeshPart(corners.astype(np.float32), faces.astype(np.int64)),)
    assert digest_of(dataclasses.replace(SCENE, objects=wide), PICTURE) == digests[7]
