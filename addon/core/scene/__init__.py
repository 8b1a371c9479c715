"""The scene as plain numpy data: what the exporter writes and the native scene reads.

Lengths are in metres, colours in linear Rec. 709, angles in radians. Matrices are row-major 4x4
float64 that map column vectors of local coordinates to world coordinates. Nothing here knows
Blender.
"""

from __future__ import annotations

from .camera import Aperture, Camera, Frame, Panorama, PanoramaKind, PixelFilter, Stereo
from .labels import Labels, Neighbours
from .lights import Light, LightKind, SunDisc, WorldMap
from .material import NO_PROGRAM, NO_TEXTURE, Extension, Interpolation, Material, Rgb, Side, Texture
from .mesh import Instances, Mesh
from .motion import CameraMotion, MeshMotion, Shutter
from .scene import GEOMETRY, SHADING, VIEW, Scene, same, same_geometry, same_shading
from .strands import Strands, StrandShape
from .visibility import ALL_GROUPS, ALL_RAYS, GROUPS, NO_LIGHT_GROUP, TERMINATOR_OFFSET, Ray

__all__ = [
    "ALL_GROUPS",
    "ALL_RAYS",
    "GEOMETRY",
    "GROUPS",
    "NO_LIGHT_GROUP",
    "NO_PROGRAM",
    "NO_TEXTURE",
    "SHADING",
    "TERMINATOR_OFFSET",
    "VIEW",
    "Aperture",
    "Camera",
    "CameraMotion",
    "Extension",
    "Frame",
    "Instances",
    "Interpolation",
    "Labels",
    "Light",
    "LightKind",
    "Material",
    "Mesh",
    "MeshMotion",
    "Neighbours",
    "Panorama",
    "PanoramaKind",
    "PixelFilter",
    "Ray",
    "Rgb",
    "Scene",
    "Shutter",
    "Side",
    "Stereo",
    "StrandShape",
    "Strands",
    "SunDisc",
    "Texture",
    "WorldMap",
    "same",
    "same_geometry",
    "same_shading",
]
