"""Blender's world -> radiance by direction: a constant, an image, or a sky and its sun."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Extension, Interpolation, Rgb, Scene, SunDisc, Texture, WorldMap
from ..core.sky import SkyModel, SkySettings, sky
from ..report import Report
from .images import Textures
from .nodes import Source, default_value, label, output_node, source, uses_nodes
from .shading import Reducer

Matrix = NDArray[np.float64]
DIRECTION_OUTPUTS = {"TEX_COORD": {"Generated", "Object"}, "NEW_GEOMETRY": {"Position"}}
"""Outputs that are the direction itself in a world."""
SKY_MODELS = {
    "SINGLE_SCATTERING": SkyModel.SINGLE_SCATTERING,
    "NISHITA": SkyModel.SINGLE_SCATTERING,
    "MULTIPLE_SCATTERING": SkyModel.MULTIPLE_SCATTERING,
    "PREETHAM": SkyModel.PREETHAM,
    "HOSEK_WILKIE": SkyModel.PREETHAM,
}


def export_world(world: Any, textures: Textures, report: Report, scene: Scene) -> None:
    """Sets `scene`'s world from a bpy.types.World; None is black. What cannot be expressed is reported and averaged."""
    if world is None:
        scene.world = (0.0, 0.0, 0.0)
        return
    owner = f"World '{world.name}'"
    if uses_nodes(world):
        _World(owner, textures, report, scene).read(world.node_tree)
    else:
        scene.world = _radiance(np.asarray(world.color, np.float64), owner, report)
    visibility = getattr(world, "cycles_visibility", None)
    rays = ("camera", "diffuse", "glossy", "transmission", "scatter")
    if visibility is not None and not all(getattr(visibility, ray, True) for ray in rays):
        report.warn(f"{owner}: ray visibility is not supported; it is visible to all rays")


class _World:
    def __init__(self, owner: str, textures: Textures, report: Report, scene: Scene) -> None:
        self.owner, self.textures, self.report, self.scene = owner, textures, report, scene
        self.reducer = Reducer(owner, textures, report)

    def read(self, tree: Any) -> None:
        output = output_node(tree)
        if output is None:
            return
        volume = source(output.inputs["Volume"])
        if volume.node is not None:
            self.report.warn(f"{self.owner}, node '{volume.node.name}': Volume not supported; left out")
        surface = source(output.inputs["Surface"])
        if not (surface.node is not None and surface.node.type in {"BACKGROUND", "EMISSION"} and self._image(surface)):
            self.scene.world = _radiance(self.reducer.shader(surface).emission.mean(self.textures), self.owner, self.report)

    def _image(self, surface: Source) -> bool:
        """Takes an image or a sky that feeds a Background; False if it is something else."""
        color = surface.input("Color")
        if color is None or color.node is None or color.node.type not in {"TEX_ENVIRONMENT", "TEX_SKY"}:
            return False
        to_lookup = self._coordinates(color)
        if to_lookup is None:
            return False
        strength = self.reducer.number(surface.input("Strength"))
        self.scene.world = _radiance(np.full(3, strength), self.owner, self.report)
        if color.node.type == "TEX_SKY":
            self._sky(color.node, to_lookup)
        else:
            texture = self.textures.of_node(color.node, f"{self.owner}, node '{label(color.node)}'")
            self.scene.world_map = WorldMap(texture, to_lookup[:3], color.node.projection == "MIRROR_BALL")
        return True

    def _coordinates(self, texture: Source) -> Matrix | None:
        """(4, 4) from a direction to what the texture looks up; None if that is no affine map of it."""
        vector = texture.input("Vector")
        own = texture.node.texture_mapping
        matrix = _mapping(own.vector_type, own.translation, own.rotation, own.scale)
        while vector is not None and vector.node is not None:
            node = vector.node
            if node.type == "MAPPING":
                values = [vector.input(name) for name in ("Location", "Rotation", "Scale")]
                if any(value is not None and value.node is not None for value in values):
                    return None
                location, rotation, scale = (
                    default_value(v.socket) if v is not None else d for v, d in zip(values, (0, 0, 1), strict=True)
                )
                matrix = matrix @ _mapping(node.vector_type, location, rotation, scale)
                vector = vector.input("Vector")
                if vector is not None and vector.node is None:
                    return None
            elif vector.socket.name in DIRECTION_OUTPUTS.get(node.type, ()) and getattr(node, "object", None) is None:
                return matrix
            else:
                return None
        return matrix

    def _sky(self, node: Any, to_lookup: Matrix) -> None:
        model = SKY_MODELS.get(node.sky_type)
        if model is None or node.sky_type == "HOSEK_WILKIE":
            self.report.warn(f"{self.owner}, node '{label(node)}': the sky model {node.sky_type} is not supported; taken as Preetham's")
            model = SkyModel.PREETHAM
        strength = self.scene.world
        if model is SkyModel.PREETHAM:
            sun = np.asarray(node.sun_direction, np.float64)
            sun = sun / max(float(np.linalg.norm(sun)), 1e-9)
            settings = SkySettings(model, math.asin(min(max(sun[2], -1.0), 1.0)), turbidity=float(node.turbidity))
            longitude = math.atan2(sun[1], sun[0])
        else:
            elevation, rotation = _wrapped(float(node.sun_elevation), float(node.sun_rotation))
            settings = SkySettings(
                model,
                elevation,
                float(node.altitude),
                float(node.air_density),
                float(getattr(node, "aerosol_density", getattr(node, "dust_density", 1.0))),
                float(node.ozone_density),
                sun_size=float(node.sun_size),
            )
            longitude = math.pi / 2.0 - rotation
        made = sky(settings)
        texture = self.textures.add(Texture("sky", made.pixels, False, Interpolation.LINEAR, Extension.EXTEND))
        c, s = math.cos(longitude), math.sin(longitude)
        turn = np.eye(4)
        turn[:2, :2] = [[c, s], [-s, c]]  # the sun of the image stands above +X
        matrix = turn @ to_lookup
        self.scene.world_map = WorldMap(texture, matrix[:3])
        if model is SkyModel.PREETHAM or not node.sun_disc:
            return
        intensity = float(node.sun_intensity)
        direction = np.linalg.pinv(matrix[:3, :3]) @ [math.cos(settings.sun_elevation), 0.0, math.sin(settings.sun_elevation)]
        if not np.isfinite(direction).all() or not np.linalg.norm(direction) > 0.0:
            return
        x, y, z = direction / np.linalg.norm(direction)
        bottom, top = (_scaled(color, strength, intensity) for color in (made.sun_bottom, made.sun_top))
        self.scene.sun_discs = [SunDisc((float(x), float(y), float(z)), settings.sun_size / 2.0, bottom, top, made.horizon)]


def _wrapped(elevation: float, rotation: float) -> tuple[float, float]:
    """A sun that has passed the zenith comes down on the other side."""
    elevation = math.remainder(elevation, 2.0 * math.pi)
    if abs(elevation) > math.pi / 2.0:
        return math.copysign(math.pi, elevation) - elevation, rotation + math.pi
    return elevation, rotation


def _mapping(kind: str, location: Any, rotation: Any, scale: Any) -> Matrix:
    """(4, 4) of Blender's Mapping node (and of a texture's own mapping)."""
    from mathutils import Euler

    place, turn, size = np.eye(4), np.eye(4), np.eye(4)
    place[:3, 3] = location
    turn[:3, :3] = np.array(Euler(np.broadcast_to(rotation, 3).tolist()).to_matrix())
    factors = np.broadcast_to(np.asarray(scale, np.float64), 3)
    if kind in {"TEXTURE", "NORMAL"}:
        factors = np.divide(1.0, factors, out=np.zeros(3), where=factors != 0.0)
    size[:3, :3] = np.diag(factors)
    if kind == "TEXTURE":
        place[:3, 3] *= -1.0
        return size @ turn.T @ place
    return turn @ size if kind in {"VECTOR", "NORMAL"} else place @ turn @ size


def _radiance(value: NDArray[np.float64], owner: str, report: Report) -> Rgb:
    if not np.isfinite(value).all() or (value < 0.0).any():
        report.warn(f"{owner}: its radiance is negative or not a finite number; taken as 0")
        value = np.where(np.isfinite(value), np.maximum(value, 0.0), 0.0)
    return (float(value[0]), float(value[1]), float(value[2]))


def _scaled(color: Rgb, strength: Rgb, intensity: float) -> Rgb:
    r, g, b = (c * s * intensity for c, s in zip(color, strength, strict=True))
    return (r, g, b)
