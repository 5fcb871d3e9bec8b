"""What a file says of a surface, as a material of the scene; textures are not read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from simmpp.scene.gltf.document import item
from simmpp.scene.gltf.schema import Document, Refraction, SpecularGlossiness, Surface
from simmpp.scene.nff_words import LARGEST
from simmpp.scene.scene import Floats, Material, Vector

LEAST_METALLIC, MOST_ROUGHNESS = 0.9, 0.3
"""Of a surface that is clearly a mirror."""
BLEND = "BLEND"
"""The mode in which what is behind a surface shines through it, by its alpha."""
MIRROR = 0.5
"""Kd and Ks of a mirror: those of the SPD's balls."""
DIELECTRIC = 0.04
"""What a surface that is no metal reflects, straight on."""
LUMINANCE = np.array([0.299, 0.587, 0.114])


def material(document: Document, index: int | None, colours: Floats | None) -> Material:
    """The material of a primitive: grey and matt if the file says nothing.

    ``colours`` of the vertices (n, 3 or 4) count where it names no material: their mean.
    """
    if index is not None:
        surface = item(document.materials, index, "materials")
        return replace(_of_surface(surface), emission=_emission(surface))
    if colours is None:
        return Material()
    red, green, blue = _steps(colours[:, :3]).mean(axis=0) / 255
    return Material((float(red), float(green), float(blue)))


def _of_surface(surface: Surface) -> Material:
    described = surface.pbr_metallic_roughness
    base, metallic = described.base_color_factor, described.metallic_factor
    roughness = described.roughness_factor
    colour = Material().colour if base is None else _colour(np.array(base))
    specular = surface.extensions.specular
    if specular is not None and not specular.is_textured:
        solved, metallic = _metallic(specular)
        colour, roughness = _colour(solved), 1 - specular.glossiness_factor
    if roughness is not None and metallic >= LEAST_METALLIC and roughness <= MOST_ROUGHNESS:
        return Material(colour, kd=MIRROR, ks=MIRROR)
    transmitted = surface.extensions.transmission.transmission_factor * (1 - metallic)
    alpha = base[3] if base is not None and surface.alpha_mode == BLEND else 1.0
    if not transmitted > 0:
        through = min(max(1 - alpha, 0.0), 1.0)  # straight on, as through a veil
        return Material(colour, 1 - through, transmittance=through)
    # An index of 0 stands for older materials' ways, which have none.
    ior = surface.extensions.refraction.ior or Refraction().ior
    straight_on = ((ior - 1) / (ior + 1)) ** 2
    return Material(colour, 1 - transmitted, straight_on, transmittance=transmitted, ior=ior)


def _emission(surface: Surface) -> Vector:
    """What it shines by itself; where only a texture says where, nothing."""
    strength = surface.extensions.emission.emissive_strength
    shares = np.array(surface.emissive_factor) * min(strength, LARGEST)
    if surface.emissive_texture is not None or not (np.abs(shares) <= LARGEST).all():
        return 0.0, 0.0, 0.0
    red, green, blue = np.maximum(shares, 0.0).tolist()
    return red, green, blue


def textured(document: Document) -> list[str]:
    """The materials in use whose textures are not read: their names, or numbers without."""
    used = {p.material for mesh in document.meshes for p in mesh.primitives}
    return [
        surface.name or str(number)
        for number, surface in enumerate(document.materials)
        if number in used and surface.is_textured
    ]


def _metallic(surface: SpecularGlossiness) -> tuple[Floats, float]:
    """Base colour and metallic factor of a specular surface: Khronos' own conversion."""
    diffuse, specular = np.array(surface.diffuse_factor[:3]), np.array(surface.specular_factor)
    rest = 1 - specular.max()
    seen = np.sqrt((LUMINANCE * specular**2).sum())
    b = np.sqrt((LUMINANCE * diffuse**2).sum()) * rest / (1 - DIELECTRIC) + seen - 2 * DIELECTRIC
    root = np.sqrt(max(b * b - 4 * DIELECTRIC * (DIELECTRIC - seen), 0.0))
    metallic = 0.0 if seen < DIELECTRIC else float(np.clip((root - b) / (2 * DIELECTRIC), 0, 1))
    of_diffuse = diffuse * rest / (1 - DIELECTRIC) / max(1 - metallic, 1e-6)
    of_specular = (specular - DIELECTRIC * (1 - metallic)) / max(metallic, 1e-6)
    share = metallic * metallic
    return share * of_specular + (1 - share) * of_diffuse, metallic


def _colour(rgb: Floats) -> Vector:
    red, green, blue = (_steps(rgb[:3]) / 255).tolist()
    return red, green, blue


def _steps(colours: Floats) -> Floats:
    """Colours of 0 ... 1 in 255 steps, as pictures have them; sums of them are exact."""
    return np.round(np.clip(np.nan_to_num(colours, posinf=0, neginf=0), 0, 1) * 255)
