"""Welding is what sorting the places would give; parts are cut together as they are one by one."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simmpp.scene import cut
from simmpp.scene.cut import cut_named, welded

# Few, so that many places are the same; neighbours; both zeros.
NUMBERS = st.sampled_from(
    [0.0, -0.0, 1.0, 1.0 + 2**-52, -1.0, 5e-324, 1e30, float(np.float32(0.1))]
)
VERTICES = st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), min_size=1, max_size=12)


def by_sorting(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corner by corner: a place gets the next number when it is met first."""
    numbers: dict[tuple[float, ...], int] = {}
    corners = [tuple(vertices[corner].tolist()) for corner in faces.ravel()]
    index = [numbers.setdefault(place, len(numbers)) for place in corners]
    firsts = [index.index(number) for number in range(len(numbers))]
    return vertices[faces.ravel()[firsts]], np.array(index).reshape(faces.shape)


@given(VERTICES, st.data())
def test_welded(rows: list[tuple[float, float, float]], data: st.DataObject) -> None:
    corner = st.integers(0, len(rows) - 1)
    faces = np.array(data.draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=9)))
    vertices = np.array(rows)
    found, expected = welded(vertices, faces), by_sorting(vertices, faces)
    assert found[0].tobytes() == expected[0].tobytes()  # 0.0 or -0.0, as the first corner has it
    np.testing.assert_array_equal(found[1], expected[1])


def test_places_of_one_number_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cut, "ODD", np.zeros(3, np.uint64))
    vertices = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0), (5, 5, 5)])
    kept, faces = welded(vertices, np.array([(3, 2, 0), (0, 1, 2)]))
    assert kept.tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 0]]
    assert faces.tolist() == [[0, 1, 2], [2, 0, 1]]


def test_neighbours_in_float32_have_numbers_of_their_own() -> None:
    """Else a fine mesh would be sorted by its places after all."""
    side = np.float32(1) + np.arange(50, dtype=np.float32) * np.float32(2**-23)
    places = np.stack(np.meshgrid(side, side, side), axis=-1).reshape(-1, 3).astype(np.float64)
    assert len(np.unique(cut._numbers(places.view(np.uint64)))) == len(places)


@pytest.mark.parametrize("most", [1, 2, 7, 100])
def test_clusters_are_the_same_one_by_one_and_together(
    monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    rng = np.random.default_rng(most)
    vertices = rng.integers(0, 5, (90, 3)).astype(np.float64)  # with ties
    faces = rng.integers(0, 90, (333, 3))
    _, cut_in_clusters = cut_named({"clusters": most})
    found = []
    for few in (1, 16, 1000):
        monkeypatch.setattr(cut, "FEW", few)
        found.append([part.tolist() for part in cut_in_clusters(vertices, faces)])
    assert found[0] == found[1] == found[2]
    assert max(map(len, found[0])) <= most < 2 * min(map(len, found[0])) + 2
    assert sorted(np.concatenate(found[0])) == list(range(333))
