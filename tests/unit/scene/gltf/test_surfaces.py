"""Materials: what the file says of colour and mirrors, as another reader takes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from gltf_files import File, nodes, one_square

from simmpp.scene.gltf.read import content
from simmpp.scene.scene import Material


def painted(*, colours: Any = None, kind: str = "f4", **surface: Any) -> Material:
    file = File()
    primitive = file.square()
    if colours is not None:
        primitive["attributes"]["COLOR_0"] = file.accessor(colours, kind)
    if surface:
        primitive["material"] = file.add("materials", **surface)
    file.node(mesh=file.mesh(primitive))
    return nodes(file.gltf(), Path("a.gltf"))[0].material


def metallic(**values: Any) -> Material:
    return painted(pbrMetallicRoughness=values)


RED = {"baseColorFactor": [1, 0, 0, 1]}
MIRROR = {"kd": 0.5, "ks": 0.5}
MATERIALS = [
    (painted(), Material()),
    (painted(name="nothing said"), Material()),
    (metallic(**RED), Material((1, 0, 0))),
    (metallic(**RED, roughnessFactor=0.3), Material((1, 0, 0), **MIRROR)),
    (metallic(**RED, roughnessFactor=0.31), Material((1, 0, 0))),
    (metallic(**RED, roughnessFactor=0, metallicFactor=0.89), Material((1, 0, 0))),
    (metallic(baseColorFactor=[2, -1, 0.5, 1]), Material((1, 0, 128 / 255))),
    (painted(colours=[(1, 0, 0)] * 2 + [(0, 0, 0.2)] * 2), Material((0.5, 0, 0.1))),
    (painted(colours=[(51, 0, 255, 9)] * 4, kind="u1"), Material((0.2, 0, 1))),
    (painted(colours=[(13107, 0, 65535)] * 4, kind="u2"), Material((0.2, 0, 1))),
    (painted(colours=[(1, 0, 0)] * 4, pbrMetallicRoughness={"roughnessFactor": 1}), Material()),
]


@pytest.mark.parametrize(("found", "expected"), MATERIALS)
def test_materials(found: Material, expected: Material) -> None:
    assert (found.kd, found.ks) == (expected.kd, expected.ks)
    assert found.colour == pytest.approx(expected.colour, abs=1e-12)


STRONG = {"KHR_materials_emissive_strength": {"emissiveStrength": 4.0}}


@pytest.mark.parametrize(
    ("surface", "emission"),
    [
        ({}, (0, 0, 0)),
        ({"emissiveFactor": [1, 0.5, 0]}, (1, 0.5, 0)),
        ({"emissiveFactor": [1, 0.5, 0], "extensions": STRONG}, (4, 2, 0)),
        ({"extensions": STRONG}, (0, 0, 0)),
        ({"emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}}, (0, 0, 0)),
        ({"emissiveFactor": [-1, 1, 1]}, (0, 1, 1)),
        ({"emissiveFactor": [1e300, 1, 1], "extensions": STRONG}, (0, 0, 0)),
    ],
)
def test_what_shines(surface: dict[str, Any], emission: tuple[float, ...]) -> None:
    assert painted(**surface).emission == emission


@pytest.mark.parametrize(
    ("surface", "reflects"),
    [
        ({"diffuseFactor": [0.2, 0.5, 0.8, 1], "specularFactor": [0, 0, 0]}, False),
        ({"diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.8, 0.2]}, True),
        ({"diffuseFactor": [0.1, 0, 0, 1], "specularFactor": [0.5] * 3}, True),
        ({"specularFactor": [1, 1, 1], "glossinessFactor": 0.5}, False),
        ({"diffuseFactor": [0.3, 0.1, 0.2, 1], "specularFactor": [0.3, 0.2, 0.1]}, False),
        ({}, True),
    ],
)
def test_specular_surfaces_as_another_reader_converts_them(
    tmp_path: Path, surface: dict[str, Any], reflects: bool
) -> None:
    file = one_square()
    file.json["meshes"][0]["primitives"][0]["material"] = file.add(
        "materials", extensions={"KHR_materials_pbrSpecularGlossiness": surface}
    )
    found = nodes(file.gltf(), Path("a.gltf"))[0].material
    scene = trimesh.load_scene(file.write(tmp_path / "a.glb"), process=False)
    (mesh,) = scene.geometry.values()
    theirs = mesh.visual.material
    assert found.colour == pytest.approx(np.array(theirs.baseColorFactor)[:3] / 255, abs=1 / 254)
    mirror = theirs.metallicFactor >= 0.9 and theirs.roughnessFactor <= 0.3
    assert found.reflects == mirror == reflects


@pytest.mark.parametrize("texture", ["diffuseTexture", "specularGlossinessTexture"])
def test_a_textured_specular_surface_is_taken_by_what_stands_beside(texture: str) -> None:
    specular = {"KHR_materials_pbrSpecularGlossiness": {texture: {"index": 0}}}
    assert painted(extensions=specular) == Material()
    beside = {"baseColorFactor": [1, 0, 0, 1]}
    assert painted(extensions=specular, pbrMetallicRoughness=beside) == Material((1, 0, 0))


def glass(factor: float = 1.0, ior: float | None = None, **values: Any) -> Material:
    extensions: dict[str, Any] = {"KHR_materials_transmission": {"transmissionFactor": factor}}
    if ior is not None:
        extensions["KHR_materials_ior"] = {"ior": ior}
    values = {"metallicFactor": 0} | values
    return painted(extensions=extensions, pbrMetallicRoughness=values)


@pytest.mark.parametrize(
    ("found", "kd", "ks", "transmittance", "ior"),
    [
        (glass(), 0, 0.04, 1, 1.5),
        (glass(0.25, 2.0), 0.75, 1 / 9, 0.25, 2),
        (glass(1, 1.0, roughnessFactor=1.0), 0, 0, 1, 1),
        (glass(1, 0), 0, 0.04, 1, 1.5),
        (glass(1, metallicFactor=0.5), 0.5, 0.04, 0.5, 1.5),
        (glass(1, metallicFactor=0.9, roughnessFactor=0.1), 0.5, 0.5, 0, 1),
        (glass(0), 1, 0, 0, 1),
    ],
)
def test_glass(found: Material, kd: float, ks: float, transmittance: float, ior: float) -> None:
    values = (found.kd, found.ks, found.transmittance, found.ior)
    assert values == pytest.approx((kd, ks, transmittance, ior))


def test_alpha_that_is_blended() -> None:
    veil = {"baseColorFactor": [1, 0, 0, 0.25]}
    found = painted(alphaMode="BLEND", pbrMetallicRoughness=veil)
    assert (found.kd, found.ks, found.transmittance, found.ior) == (0.25, 0, 0.75, 1)
    for mode in ("MASK", "OPAQUE"):
        assert not painted(alphaMode=mode, pbrMetallicRoughness=veil).transmits


def test_textures_are_said() -> None:
    file = one_square()
    textured = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    file.add("materials", name="unused", **textured)
    index = file.add("materials", name="bricks", **textured)
    file.json["meshes"][0]["primitives"][0]["material"] = index
    (note,) = content(file.gltf(), Path("a.gltf")).notes
    assert note == "textures of 'bricks' are not read: its colour is the one without"
