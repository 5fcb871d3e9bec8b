"""The description of a scene, counted by hand."""

import json

from simmpp.scene.describe import describe, object_table
from simmpp.workload.sources import load_scene


def test_description_of_the_smallest_mountain() -> None:
    found = describe(load_scene("mountain:1"))
    assert found["name"] == "mountain:1"
    assert found["n_objects"] == 12
    assert found["objects"] == {"sphere": 4, "polygon": 8}
    assert found["triangles"] == 8
    assert found["bytes"] == 12 * 128
    assert (found["reflecting"], found["transmitting"]) == (4, 4)
    assert [material["n_objects"] for material in found["materials"]] == [4, 8]
    assert [material["transmits"] for material in found["materials"]] == [True, False]
    assert len(found["lights"]) == 1
    assert found["camera"]["eye"] == [-1.6, 1.6, 1.7]
    assert found["box"]["low"][1] == -1 and found["box"]["high"][0] == 1
    assert json.loads(json.dumps(found)) == found


def test_reflecting_is_not_transmitting() -> None:
    found = describe(load_scene("rings:1"))
    assert (found["reflecting"], found["transmitting"]) == (60, 0)


def test_table_has_a_row_per_object() -> None:
    scene = load_scene("gears:1")
    table = object_table(scene)
    assert len(table) == len(scene.objects) == 147
    assert table.id.tolist() == list(range(147))
    ground, top = table.iloc[0], table.iloc[1]
    assert (ground.kind, ground.triangles, ground.bytes) == ("polygon", 2, 128 + 24)
    assert (top.triangles, top.bytes, top.material) == (142, 128 + 24 * 141, 1)
    assert (ground.x_low, ground.x_high, ground.z_low, ground.z_high) == (-2, 2, 0, 0)
    assert table.triangles.sum() == describe(scene)["triangles"]
    assert table.bytes.sum() == describe(scene)["bytes"]
