"""What is read of the JSON: where triangles are, how they look, from where, by which light.

Names are the format's, in Python's spelling. What else a file holds (pictures, animations,
``extras``) is not looked at; what it says of these is checked before it is used.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic.alias_generators import to_camel


def _whole(value: Any) -> Any:
    return int(value) if isinstance(value, float) and value.is_integer() else value


Integer = Annotated[int, BeforeValidator(_whole), Field(ge=0, lt=2**53)]
"""JSON has one kind of number: 1.0 is an integer, too, and 2**53 the first that may be another."""
Vec3 = Annotated[list[float], Field(min_length=3, max_length=3)]
Vec4 = Annotated[list[float], Field(min_length=4, max_length=4)]
Mat4 = Annotated[list[float], Field(min_length=16, max_length=16)]


class _Part(BaseModel):
    model_config = ConfigDict(
        strict=True,
        frozen=True,
        allow_inf_nan=False,
        alias_generator=to_camel,
    )


class Buffer(_Part):
    """Bytes, in a file beside, in a ``data:`` URI, or in the second chunk of a GLB."""

    byte_length: Integer
    uri: str | None = None


class BufferView(_Part):
    """A stretch of a buffer."""

    buffer: Integer
    byte_offset: Integer = 0
    byte_length: Integer
    byte_stride: Integer | None = None


class SparseIndices(_Part):
    """Which elements of an accessor are replaced."""

    buffer_view: Integer
    byte_offset: Integer = 0
    component_type: Integer


class SparseValues(_Part):
    """What they are replaced by."""

    buffer_view: Integer
    byte_offset: Integer = 0


class Sparse(_Part):
    """Elements that differ from what the accessor's view holds, or from 0 without a view."""

    count: Annotated[Integer, Field(ge=1)]
    indices: SparseIndices
    values: SparseValues


class Accessor(_Part):
    """Numbers in a view."""

    buffer_view: Integer | None = None
    byte_offset: Integer = 0
    component_type: Integer
    normalized: bool = False
    count: Annotated[Integer, Field(ge=1)]
    type: str
    sparse: Sparse | None = None


class PrimitiveExtensions(_Part):
    """What a primitive's extensions say."""

    draco: Any = Field(default=None, alias="KHR_draco_mesh_compression")


class Primitive(_Part):
    """Geometry of one material."""

    attributes: dict[str, Integer]
    indices: Integer | None = None
    material: Integer | None = None
    mode: Annotated[Integer, Field(le=6)] = 4
    targets: list[dict[str, Integer]] = []
    extensions: PrimitiveExtensions = PrimitiveExtensions()


class Mesh(_Part):
    """Primitives that a node places together."""

    primitives: Annotated[list[Primitive], Field(min_length=1)]
    weights: list[float] = []


class Instancing(_Part):
    """Accessors of TRANSLATION, ROTATION and SCALE, an element for each copy of the mesh."""

    attributes: dict[str, Integer]


class Visibility(_Part):
    """Whether a node and all below it are seen."""

    visible: bool = True


class PlacedLight(_Part):
    """Which light is there."""

    light: Integer


class NodeExtensions(_Part):
    """What a node's extensions say."""

    light: PlacedLight | None = Field(default=None, alias="KHR_lights_punctual")
    instancing: Instancing | None = Field(default=None, alias="EXT_mesh_gpu_instancing")
    visibility: Visibility = Field(default=Visibility(), alias="KHR_node_visibility")


class Node(_Part):
    """A place, with or without a mesh, a camera or a light there."""

    name: str | None = None
    mesh: Integer | None = None
    camera: Integer | None = None
    skin: Integer | None = None
    children: list[Integer] = []
    matrix: Mat4 | None = None
    translation: Vec3 | None = None
    rotation: Vec4 | None = None
    scale: Vec3 | None = None
    weights: list[float] | None = None
    extensions: NodeExtensions = NodeExtensions()


class Scene(_Part):
    """Roots of trees of nodes."""

    nodes: list[Integer] = []


class Perspective(_Part):
    """What a pinhole camera sees; how wide, the picture decides."""

    yfov: float


class Camera(_Part):
    """A camera, in the place of its node: it looks along -z, with y upwards."""

    name: str | None = None
    type: str
    perspective: Perspective | None = None


class Punctual(_Part):
    """A light in the place of its node; one with a direction shines along -z."""

    type: str
    color: Vec3 = [1.0, 1.0, 1.0]
    intensity: Annotated[float, Field(ge=0)] = 1.0


class Punctuals(_Part):
    """The lights of a file."""

    lights: list[Punctual] = []


class DocumentExtensions(_Part):
    """What a file's extensions say."""

    punctual: Punctuals = Field(default=Punctuals(), alias="KHR_lights_punctual")


class MetallicRoughness(_Part):
    """A surface as glTF 2.0 describes it."""

    base_color_factor: Vec4 | None = None
    base_color_texture: Any = None
    metallic_factor: float = 1.0
    roughness_factor: float | None = None
    metallic_roughness_texture: Any = None


class SpecularGlossiness(_Part):
    """A surface as files of before describe it."""

    diffuse_factor: Vec4 = [1.0, 1.0, 1.0, 1.0]
    diffuse_texture: Any = None
    specular_factor: Vec3 = [1.0, 1.0, 1.0]
    glossiness_factor: float = 1.0
    specular_glossiness_texture: Any = None

    @property
    def is_textured(self) -> bool:
        """Its factors alone don't say how it looks."""
        return not (self.diffuse_texture is None and self.specular_glossiness_texture is None)


class Transmission(_Part):
    """How much of the light that is not reflected passes."""

    transmission_factor: Annotated[float, Field(ge=0, le=1)] = 0.0
    transmission_texture: Any = None


class Refraction(_Part):
    """How far what passes is bent."""

    ior: Annotated[float, Field(ge=0)] = 1.5


class Emission(_Part):
    """How much brighter than its factor a material shines."""

    emissive_strength: Annotated[float, Field(ge=0)] = 1.0


class MaterialExtensions(_Part):
    """What a material's extensions say."""

    specular: SpecularGlossiness | None = Field(
        default=None, alias="KHR_materials_pbrSpecularGlossiness"
    )
    transmission: Transmission = Field(default=Transmission(), alias="KHR_materials_transmission")
    refraction: Refraction = Field(default=Refraction(), alias="KHR_materials_ior")
    emission: Emission = Field(default=Emission(), alias="KHR_materials_emissive_strength")


class Surface(_Part):
    """A material."""

    name: str | None = None
    alpha_mode: str = "OPAQUE"
    pbr_metallic_roughness: MetallicRoughness = MetallicRoughness()
    emissive_factor: Vec3 = [0.0, 0.0, 0.0]
    emissive_texture: Any = None
    extensions: MaterialExtensions = MaterialExtensions()

    @property
    def is_textured(self) -> bool:
        """Its factors alone don't say how it looks."""
        plain, extended = self.pbr_metallic_roughness, self.extensions
        specular = extended.specular is not None and extended.specular.is_textured
        textures = (
            plain.base_color_texture,
            plain.metallic_roughness_texture,
            extended.transmission.transmission_texture,
        )
        return specular or any(texture is not None for texture in textures)


class Document(_Part):
    """The whole of it."""

    accessors: list[Accessor] = []
    buffers: list[Buffer] = []
    buffer_views: list[BufferView] = []
    cameras: list[Camera] = []
    extensions: DocumentExtensions = DocumentExtensions()
    materials: list[Surface] = []
    meshes: list[Mesh] = []
    nodes: list[Node] = []
    scene: Integer | None = None
    scenes: list[Scene] = []


class Asset(_Part):
    """Which glTF this is."""

    version: Any
    min_version: Any = "2.0"


class Head(_Part):
    """What must be known before the rest is understood."""

    asset: Asset
    extensions_required: list[str] = []
