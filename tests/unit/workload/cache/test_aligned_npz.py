"""Arrays that are used where they lie in their file: aligned, checked, readable by numpy."""

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of

from simmpp.common.errors import WorkloadError
from simmpp.workload.cache.aligned_npz import ALIGNMENT, map_arrays, write_aligned
from simmpp.workload.cache.store import load, open_workload, save
from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.tracer import trace

ARRAY = arrays_of.arrays(
    st.sampled_from([np.uint8, np.int32, np.int64, np.float64]),
    arrays_of.array_shapes(max_dims=2, min_side=0, max_side=40),
)
NAMES = st.text("abcdefgh_", min_size=1, max_size=30)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("npz") / "a.npz"


@given(st.dictionaries(NAMES, ARRAY, min_size=1, max_size=5))
def test_round_trip(path: Path, arrays: dict[str, np.ndarray]) -> None:
    with open(path, "wb") as file:
        write_aligned(file, arrays)
    mapped = map_arrays(path)
    with np.load(path, allow_pickle=False) as file:
        assert set(file) == set(mapped) == set(arrays)
        for name, array in arrays.items():
            for read in (file[name], mapped[name]):
                assert read.dtype == array.dtype
                np.testing.assert_array_equal(read, array)
            assert not mapped[name].flags.writeable
            assert mapped[name].size == 0 or mapped[name].ctypes.data % ALIGNMENT == 0


def test_equal_arrays_make_equal_files() -> None:
    files = [io.BytesIO(), io.BytesIO()]
    for file in files:
        write_aligned(file, {"a": np.arange(3), "b": np.ones((2, 2))})
    assert files[0].getvalue() == files[1].getvalue()


def test_what_lies_askew_is_copied(path: Path) -> None:
    """As in files that numpy wrote."""
    for name in ("a", "ab", "abc", "abcd"):
        np.savez(path, **{name: np.arange(5.0)})
        (array,) = map_arrays(path).values()
        assert array.flags.aligned
        assert array.tolist() == [0, 1, 2, 3, 4]


def test_compressed_members_are_refused(path: Path) -> None:
    np.savez_compressed(path, a=np.zeros(9))
    with pytest.raises(ValueError, match="expected an uncompressed member"):
        map_arrays(path)


@pytest.fixture(scope="module")
def workload_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("workload") / "w.npz"
    save(trace(load_scene("tetra:1"), Picture(resolution=4)), file)
    return file


def test_a_workload_opened_is_the_one_loaded(workload_file: Path) -> None:
    opened, loaded = open_workload(workload_file), load(workload_file)
    for name, value in vars(loaded).items():
        np.testing.assert_array_equal(getattr(opened, name), value)


@given(st.data())
def test_damage_is_noticed_or_harmless(
    workload_file: Path, path: Path, data: st.DataObject
) -> None:
    """Never other rays, never anything but a WorkloadError."""
    content = bytearray(workload_file.read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    if data.draw(st.booleans()):
        content[at] ^= data.draw(st.integers(1, 255))
    else:
        del content[at:]
    path.write_bytes(content)
    expected = load(workload_file)
    try:
        opened = open_workload(path)
    except WorkloadError:
        return
    for name, value in vars(expected).items():
        np.testing.assert_array_equal(getattr(opened, name), value)


def test_the_archive_is_a_plain_one(workload_file: Path) -> None:
    with zipfile.ZipFile(workload_file) as archive:
        assert archive.testzip() is None
