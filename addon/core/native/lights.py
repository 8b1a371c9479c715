"""Hands lamps and world to the native renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..scene import NO_PROGRAM, Scene
from .convert import first_of, naming, rgb
from .instances import instance_order, name_of

if TYPE_CHECKING:
    from photon_splat_native import Renderer

ANY_BOUNCES = 0xFFFFFFFF


def add_lights(renderer: Renderer, scene: Scene) -> None:
    """Lamps, light groups, world and sun discs, after the programs that they refer to."""
    for light in scene.lights:
        with naming(f"light '{light.name}'"):
            renderer.add_lamp(
                kind=str(light.kind),
                matrix=np.ascontiguousarray(light.matrix, np.float64),
                strength=rgb(light.strength),
                radius=light.radius,
                soft_falloff=light.soft_falloff,
                spot_size=light.spot_size,
                spot_blend=light.spot_blend,
                angle=light.angle,
                size=[float(c) for c in light.size],
                ellipse=light.ellipse,
                spread=light.spread,
                normalize=light.normalize,
                camera_visible=light.camera_visible,
                program=light.program,
                lit_groups=light.lit_groups,
                blockers=light.blockers,
                light_group=light.light_group,
                seen_by=light.seen_by,
                max_bounces=ANY_BOUNCES if light.max_bounces is None else light.max_bounces,
                met_by_rays=light.met_by_rays,
                casts_shadows=light.casts_shadows,
            )
    renderer.set_light_groups(len(scene.light_groups), scene.world_light_group)
    renderer.set_world(rgb(scene.world), scene.world_seen_by)
    if scene.world_map is not None:
        rows = np.vstack([np.asarray(scene.world_map.to_lookup, np.float64), [0.0, 0.0, 0.0, 1.0]])
        renderer.set_world_map(
            scene.world_map.texture, scene.world_map.mirror_ball, np.ascontiguousarray(rows)
        )
    for sun in scene.sun_discs:
        renderer.add_sun_disc(
            [float(c) for c in sun.direction],
            sun.half_angle,
            rgb(sun.bottom),
            rgb(sun.top),
            sun.horizon,
        )
    if scene.world_program != NO_PROGRAM:
        renderer.set_world_program(scene.world_program)
    if scene.world_volume != NO_PROGRAM:
        renderer.set_world_volume(scene.world_volume)


def lights_in_surfaces(renderer: Renderer, scene: Scene) -> list[str]:
    """One warning about lights that lie in the plane of a surface: how much of their light gets
    past it is decided by rounding.
    """
    added = instance_order(scene)

    def thing(instance: int) -> str:
        return name_of(scene, int(added[instance]))

    pairs = [
        f"'{scene.lights[lamp].name if lamp >= 0 else thing(emissive)}' in '{thing(instance)}'"
        for lamp, emissive, instance in renderer.lights_in_surfaces
    ]
    if not pairs:
        return []
    return [
        f"Lights lie exactly in a surface ({first_of(pairs)}), which keeps back a part of their "
        "light by chance: move them off it."
    ]
