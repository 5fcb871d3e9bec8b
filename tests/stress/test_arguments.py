"""Python's calls refuse what a configuration would: numbers that are none, words nobody knows."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import simmpp
from simmpp.common.errors import ConfigError, SceneError
from simmpp.scene.scene import Camera, Cone, Light, Material, MeshPart, Polygon, Scene, Sphere
from simmpp.workload.cache.store import workload_for

NAN, INF = float("nan"), float("inf")
TRIANGLE = np.array([[-1.0, 0, -1], [1, 0, -1], [0, 0, 1]])
SCENE = Scene(
    "made",
    (Polygon(TRIANGLE),),
    (Material(),),
    (Light((0.0, -9.0, 9.0)),),
    Camera((0.0, -4.0, 0.0), (0.0, 0.0, 0.0)),
)
NOT_COUNTS = (NAN, INF, -1, 2.5, True, "4", None, 2**70)


def refused(call: Any, *arguments: Any, **named: Any) -> str:
    with pytest.raises(ConfigError) as caught:
        call(*arguments, **named)
    assert "\n" not in str(caught.value) and "expected" in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("value", NOT_COUNTS)
def test_what_is_no_count(value: object) -> None:
    refused(simmpp.Picture, resolution=value)
    refused(simmpp.Picture, max_depth=value)
    refused(simmpp.Memory, transient=value)
    refused(simmpp.PolicyParameters, "object", batch=value)
    refused(simmpp.PolicyParameters, "object", ask_at_least=value)
    refused(simmpp.make_machine, "t3e", processors=value)
    if value is not None:
        refused(simmpp.Memory, bytes=value)
        refused(simmpp.PolicyParameters, "object", refresh_ps=value)
    workload = simmpp.trace(SCENE, simmpp.Picture(resolution=2))
    rest = simmpp.Memory(), simmpp.PlacementRules()
    refused(simmpp.place, workload, value, *rest, 0)
    refused(simmpp.place, workload, 2, *rest, value)


def test_what_is_no_share_and_no_word() -> None:
    for value in (NAN, INF, -0.1, 1.1, Fraction(3, 2), "1 GB", "150%", None, True):
        refused(simmpp.Memory, fraction=value)
    for value in (NAN, 0.5, -1, Fraction(-1, 2), 2**31, "12", "120%", None):
        refused(simmpp.PolicyParameters, "concurrent", min_load=value)
    for call, name in (
        (simmpp.Picture, "samples"),
        (simmpp.Memory, "residents"),
        (simmpp.PlacementRules, "owners"),
        (simmpp.PlacementRules, "pixels"),
    ):
        for word in ("", "x", None, NAN):
            assert refused(call, **{name: word}).startswith(f"{name}: value ")
    refused(simmpp.PolicyParameters, "object", load_info="x")
    for value in (Fraction(3, 2), Fraction(-1, 2), "150%", "x%", "1", 0.1):
        assert refused(simmpp.Memory, transient=value).startswith("transient: value ")


@pytest.mark.parametrize("value", [0, *NOT_COUNTS])
def test_what_is_no_side_of_cells(value: object) -> None:
    assert refused(simmpp.Cells, value).startswith("cells: value ")
    pixels = {"cells": value}
    assert refused(simmpp.PlacementRules, pixels=pixels).startswith("pixels: cells: value ")


def test_numbers_of_numpy_are_numbers() -> None:
    workload = simmpp.trace(SCENE, simmpp.Picture(resolution=np.int64(2)))
    rest = simmpp.Memory(fraction=0.5, transient=np.int32(1)), simmpp.PlacementRules()
    assert simmpp.place(workload, np.int16(2), *rest, np.uint8(0)).processors == 2


@pytest.mark.parametrize("value", [NAN, INF, -INF])
@pytest.mark.parametrize(
    "make",
    [
        lambda x: Sphere((x, 0.0, 0.0), 1.0),
        lambda x: Sphere((0.0, 0.0, 0.0), x),
        lambda x: Cone((0.0, x, 0.0), 1.0, (0.0, 0.0, 1.0), 0.5),
        lambda x: Cone((0.0, 0.0, 0.0), 1.0, (0.0, 0.0, 1.0), x),
        lambda x: Polygon(np.where(TRIANGLE == 1, x, TRIANGLE)),
        lambda x: MeshPart(np.where(TRIANGLE == 1, x, TRIANGLE), np.array([[0, 1, 2]], np.int32)),
    ],
)
def test_coordinates_that_are_not_finite(make: Any, value: float) -> None:
    with pytest.raises(SceneError, match="object 1 has a coordinate that is not finite"):
        simmpp.trace(changed(objects=(SCENE.objects[0], make(value))), simmpp.Picture(resolution=2))


def changed(**fields: Any) -> Scene:
    return dataclasses.replace(SCENE, **fields)


CAMERA = SCENE.camera


@pytest.mark.parametrize(
    ("scene", "problem"),
    [
        (changed(materials=(Material(kd=NAN),)), "material 0 has the number nan"),
        (changed(materials=(Material(ks=INF),)), "material 0 has the number inf"),
        (changed(materials=(Material((-1.0, 0.0, 0.0)),)), "material 0 has the number -1"),
        (changed(materials=(Material(transmittance=1.5, ior=1.0),)), "transmittance 1.5"),
        (changed(materials=(Material(transmittance=1.0, ior=NAN),)), "its ior is nan"),
        (changed(materials=()), "object 0 has material 0"),
        (changed(lights=(Light((0.0, 0.0, NAN)),)), "a light is not finite"),
        (changed(lights=(Light((0.0, 0.0, 9.0), (1.0, NAN, 1.0)),)), "colour of light 0"),
        (changed(background=(0.0, INF, 0.0)), "the background"),
        (changed(objects=(Polygon(TRIANGLE[:2]),)), "a polygon of 2 vertices"),
        (changed(objects=(Polygon(TRIANGLE[:, :2]),)), r"vertices of shape \(3, 2\)"),
        (changed(objects=(MeshPart(TRIANGLE, np.zeros((0, 3), np.int32)),)), "faces of shape"),
        (
            changed(objects=(MeshPart(TRIANGLE, np.array([[0, 1, 3]], np.int32)),)),
            "outside 0 ... 2",
        ),
        (changed(objects=(MeshPart(TRIANGLE, np.array([[0, -1, 2]], np.int32)),)), "outside 0 ..."),
        (changed(camera=dataclasses.replace(CAMERA, eye=(NAN, 0.0, 0.0))), "camera is not finite"),
        (changed(camera=dataclasses.replace(CAMERA, up=(0.0, 0.0, INF))), "camera is not finite"),
        (changed(camera=dataclasses.replace(CAMERA, up=(0.0, 0.0, 5e-324))), "or zero"),
        (changed(camera=dataclasses.replace(CAMERA, angle_degrees=NAN)), "angle is nan"),
    ],
)
def test_scenes_that_no_renderer_could_use(scene: Scene, problem: str) -> None:
    for call in (simmpp.trace, workload_for):
        with pytest.raises(SceneError, match=problem) as caught:
            call(scene, simmpp.Picture(resolution=2))
        assert "\n" not in str(caught.value)
