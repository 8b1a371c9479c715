"""Hands a `Scene` to the native renderer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..render.settings import FinalGather, RenderSettings
from ..scene import (
    ALL_GROUPS,
    ALL_RAYS,
    NO_LIGHT_GROUP,
    NO_PROGRAM,
    TERMINATOR_OFFSET,
    Camera,
    Frame,
    Mesh,
    Scene,
    Side,
    Strands,
    Texture,
)
from ..scene.shading import Program
from .library import load

if TYPE_CHECKING:
    from photon_splat_native import Renderer

ANY_BOUNCES = 0xFFFFFFFF


FAR = 100.0
"""Objects within 1 / FAR of the scene's size around the camera count as near, all others as far."""


def world_bounds(scene: Scene) -> NDArray[np.float64]:
    """(2, 3) lower and upper corner, m, of boxes around all instances; the camera's place for an
    empty scene.
    """
    return _around(_instance_boxes(scene), scene)


def _around(boxes: NDArray[np.float64], scene: Scene) -> NDArray[np.float64]:
    if not len(boxes):
        return np.stack([scene.camera.matrix[:3, 3]] * 2)
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def _instance_boxes(scene: Scene) -> NDArray[np.float64]:
    """(I, 2, 3) lower and upper corner in the world, m; instances without a triangle are left
    out.
    """
    instances = scene.instances
    filled = np.array(
        [len(mesh.triangles) > 0 or mesh.strands is not None for mesh in scene.meshes], bool
    )
    corners = np.zeros((len(scene.meshes), 8, 3))
    for i in np.flatnonzero(filled):
        box = _box(scene.meshes[i])
        corners[i] = np.array(
            [[box[a, 0], box[b, 1], box[c, 2]] for a in (0, 1) for b in (0, 1) for c in (0, 1)]
        )
    shown = filled[instances.mesh] if len(instances.mesh) else np.zeros(0, bool)
    matrices = instances.matrix[shown]
    world = (
        np.einsum("ijk,ick->icj", matrices[:, :3, :3], corners[instances.mesh[shown]])
        + matrices[:, None, :3, 3]
    )
    return np.stack([world.min(axis=1), world.max(axis=1)], axis=1)


def _box(mesh: Mesh) -> NDArray[np.float64]:
    """(2, 3) lower and upper corner of the triangles; vertices that none of them uses do not
    count.
    """
    if mesh.strands is not None:
        keys = mesh.strands.keys
        return np.stack(
            [(keys[:, :3] - keys[:, 3:]).min(axis=0), (keys[:, :3] + keys[:, 3:]).max(axis=0)]
        ).astype(np.float64)
    axes = mesh.positions.T  # one at a time: numpy takes twenty times as long over axis 0
    ends = [int(at) for axis in axes for at in (axis.argmin(), axis.argmax())]
    if not all((mesh.triangles == end).any() for end in set(ends)):
        used = np.zeros(len(mesh.positions), bool)
        used[mesh.triangles] = True
        axes = mesh.positions[used].T
    return np.array([[axis.min() for axis in axes], [axis.max() for axis in axes]], np.float64)


def focus(scene: Scene) -> tuple[NDArray[np.float64], float]:
    """The origin of the renderer's coordinates, and the radius of the near objects (0: there are no
    far ones).

    Rounding errors grow with the distance from the origin. It is the middle of the scene, or of the
    near objects where others are very far away.
    """
    boxes = _instance_boxes(scene)
    bounds = _around(boxes, scene)
    origin, near = bounds.mean(axis=0), 0.0
    eye = scene.camera.matrix[:3, 3]
    reach = np.abs(boxes - eye).max(axis=(1, 2)) if len(boxes) else np.zeros(0)
    size = 0.5 * float(np.linalg.norm(bounds[1] - bounds[0]))
    while np.isfinite(size):
        close = boxes[reach < size / FAR]
        if not len(close):
            break
        low, high = close[:, 0].min(axis=0), close[:, 1].max(axis=0)
        origin, near = 0.5 * (low + high), max(0.5 * float(np.linalg.norm(high - low)), 1e-6 * size)
        size = near
    return origin, near


def fill_renderer(renderer: Renderer, scene: Scene, settings: RenderSettings) -> None:
    """Copies everything into `renderer`. ValueError, with one sentence, for data that is not finite
    or does not fit.
    """
    origin, near = focus(scene)
    if not np.isfinite(origin).all():
        raise ValueError("the scene has an instance whose position in the world is not finite")
    renderer.set_origin([float(c) for c in origin], near)
    if scene.shutter is not None:
        renderer.set_shutter(
            np.ascontiguousarray(scene.shutter.curve, np.float32), scene.shutter.rolling
        )
    _add_materials(renderer, scene)
    grids: dict[int, int] = {}
    for index, mesh in enumerate(scene.meshes):
        with _naming(f"mesh '{mesh.name}'"):
            if mesh.strands is not None:
                _add_strands(renderer, index, mesh.strands)
                add_mesh_shading(renderer, index, mesh)
                continue
            renderer.add_mesh(
                np.ascontiguousarray(mesh.positions, np.float32),
                np.ascontiguousarray(mesh.triangles, np.uint32),
                _contiguous(mesh.corner_normals, np.float32),
                _contiguous(mesh.uv, np.float32),
                _contiguous(mesh.slots, np.uint16),
                _contiguous(mesh.vertex_normals, np.float32),
            )
            add_mesh_shading(renderer, index, mesh)
            _add_grids(renderer, index, mesh, grids)
            if mesh.motion is not None:
                renderer.set_mesh_motion(
                    index,
                    np.ascontiguousarray(mesh.motion.positions, np.float32),
                    _contiguous(mesh.motion.corner_normals, np.float32),
                    _contiguous(mesh.motion.vertex_normals, np.float32),
                )
    _add_instances(renderer, scene)
    _add_lights(renderer, scene)
    place_camera(renderer, scene.camera, scene.frame)
    set_options(renderer, scene, settings)


SAME_OPTIONS = (
    "photons_per_pass",
    "max_bounces",
    "radius_scale",
    "point_spacing",
    "boundary_correction",
    "caustics",
    "adaptive_radius",
    "adaptive_samples",
    "occlusion",
    "fallback",
)
"""Settings that the renderer has by the same name."""


def _has_media(scene: Scene) -> bool:
    return scene.world_volume != NO_PROGRAM or any(
        material.volume != NO_PROGRAM for material in scene.materials
    )


def set_options(renderer: Renderer, scene: Scene, settings: RenderSettings) -> None:
    """What the renderer is to know of `settings`, before it is built."""
    native = load()
    options = renderer.options
    for name in SAME_OPTIONS:
        setattr(options, name, getattr(settings, name))
    options.force_caustics = "caustics" in settings.force
    options.seed = settings.seed & 0xFFFFFFFF
    if settings.final_gather == FinalGather.ON:
        options.final_gather = native.FinalGather.ON
    elif settings.final_gather == FinalGather.AUTO and settings.denoise:
        options.final_gather = native.FinalGather.BY_TRIAL
    else:
        options.final_gather = native.FinalGather.OFF
    options.tries_paths = (
        settings.final_gather == FinalGather.AUTO
        and not settings.denoise
        and "photons" not in settings.force
        # Of light that media scatter photons may bring little.
        and bool(settings.time_limit or settings.error_threshold or _has_media(scene))
    )


def replace_shading(renderer: Renderer, scene: Scene) -> None:
    """Replaces materials, textures, lights and world of a renderer whose geometry is that of
    `scene`.
    """
    renderer.clear_shading()
    _add_materials(renderer, scene)
    _add_lights(renderer, scene)
    renderer.relight()


def add_textures(renderer: Renderer, textures: Sequence[Texture]) -> None:
    # index of the first texture with these pixels: the others only read them differently and share
    # its memory
    stored: dict[int, int] = {}
    for index, texture in enumerate(textures):
        first = stored.setdefault(id(texture.pixels), index)
        if first != index and textures[first].srgb == texture.srgb:
            renderer.add_texture_reading(first, str(texture.interpolation), str(texture.extension))
            continue
        renderer.add_texture(
            np.ascontiguousarray(texture.pixels),
            texture.srgb,
            str(texture.interpolation),
            str(texture.extension),
        )


def add_program(renderer: Renderer, program: Program) -> int:
    """Returns its index."""
    return renderer.add_program(
        program.name, program.code, program.constants, program.registers, int(program.features)
    )


def _add_materials(renderer: Renderer, scene: Scene) -> None:
    add_textures(renderer, scene.textures)
    for program in scene.programs:
        add_program(renderer, program)
    for material in scene.materials:
        with _naming(f"material '{material.name}'"):
            if material.program != NO_PROGRAM:
                renderer.add_program_material(material.program)
            else:
                renderer.add_material(_side(material.front), _side(material.back))
            if material.volume != NO_PROGRAM:
                renderer.set_volume(material.volume)


def _add_strands(renderer: Renderer, index: int, strands: Strands) -> None:
    renderer.add_strands(
        np.ascontiguousarray(strands.keys, np.float32),
        _contiguous(strands.first, np.uint32),
        str(strands.shape),
        strands.subdivisions,
        _contiguous(strands.slots, np.uint16),
        _contiguous(strands.uv, np.float32),
    )
    if strands.motion is not None:
        renderer.set_strand_motion(index, np.ascontiguousarray(strands.motion, np.float32))


def _add_lights(renderer: Renderer, scene: Scene) -> None:
    for light in scene.lights:
        with _naming(f"light '{light.name}'"):
            renderer.add_lamp(
                kind=str(light.kind),
                matrix=np.ascontiguousarray(light.matrix, np.float64),
                strength=_rgb(light.strength),
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
    renderer.set_world(_rgb(scene.world), scene.world_seen_by)
    if scene.world_map is not None:
        rows = np.vstack([np.asarray(scene.world_map.to_lookup, np.float64), [0.0, 0.0, 0.0, 1.0]])
        renderer.set_world_map(
            scene.world_map.texture, scene.world_map.mirror_ball, np.ascontiguousarray(rows)
        )
    for sun in scene.sun_discs:
        renderer.add_sun_disc(
            [float(c) for c in sun.direction],
            sun.half_angle,
            _rgb(sun.bottom),
            _rgb(sun.top),
            sun.horizon,
        )
    if scene.world_program != NO_PROGRAM:
        renderer.set_world_program(scene.world_program)
    if scene.world_volume != NO_PROGRAM:
        renderer.set_world_volume(scene.world_volume)


def place_camera(renderer: Renderer, camera: Camera, frame: Frame) -> None:
    """Sets the camera. A renderer that has been built takes it over with set_view()."""
    screen = [float(c) for c in camera.screen]
    renderer.set_shading_view(
        np.ascontiguousarray(camera.matrix, np.float64), screen, camera.orthographic
    )
    renderer.set_camera(
        matrix=np.ascontiguousarray(camera.matrix, np.float64),
        screen=screen,
        orthographic=camera.orthographic,
        clip_start=camera.clip_start,
        clip_end=camera.clip_end,
        frame=[frame.width, frame.height],
        region=list(frame.region),
        transparent=frame.transparent,
        transparent_glass=frame.transparent_glass,
        pixel_filter=str(frame.pixel_filter),
        filter_width=frame.filter_width,
        exposure=frame.exposure,
    )
    if camera.panorama is not None:
        panorama: dict[str, Any] = {
            k: list(v) if isinstance(v, tuple) else v for k, v in asdict(camera.panorama).items()
        }
        renderer.set_panorama(**panorama | {"kind": str(camera.panorama.kind)})
    if camera.aperture is not None:
        renderer.set_aperture(**asdict(camera.aperture))
    if camera.motion is not None:
        renderer.set_camera_motion(
            np.ascontiguousarray(camera.motion.matrices, np.float64), list(camera.motion.zoom)
        )


def _add_instances(renderer: Renderer, scene: Scene) -> None:
    instances = scene.instances
    material_sets = [[int(m) for m in s] for s in scene.material_sets]
    matrices = np.ascontiguousarray(instances.matrix, np.float64)
    flat = find_flat(scene)
    count = len(flat)
    groups = np.zeros(count, int) if instances.group is None else instances.group
    lit = [ALL_GROUPS] * count if instances.lit_groups is None else instances.lit_groups.tolist()
    blockers = [ALL_GROUPS] * count if instances.blockers is None else instances.blockers.tolist()
    light_groups = (
        [NO_LIGHT_GROUP] * count
        if instances.light_group is None
        else instances.light_group.tolist()
    )
    seen_by = [ALL_RAYS] * count if instances.seen_by is None else instances.seen_by.tolist()
    holdout = [False] * count if instances.holdout is None else instances.holdout.tolist()
    catcher = [False] * count if instances.catcher is None else instances.catcher.tolist()
    offset = (
        [TERMINATOR_OFFSET] * count
        if instances.terminator_offset is None
        else instances.terminator_offset.tolist()
    )
    # Of surfaces that coincide rays meet the one that was added first; Cycles shows the object that
    # comes last.
    for i in _order(flat):
        materials = material_sets[int(instances.material_set[i])]
        linking = (int(groups[i]), lit[i], blockers[i], light_groups[i])
        renderer.add_instance(
            int(instances.mesh[i]),
            matrices[i],
            materials,
            *linking,
            seen_by[i],
            holdout[i],
            offset[i],
            catcher[i],
        )
        if instances.density is not None and instances.density[i] != 1.0:
            renderer.set_density(float(instances.density[i]))
        if int(i) in instances.motion:
            renderer.set_motion(np.ascontiguousarray(instances.motion[int(i)], np.float64))
    for attribute in instances.attributes:
        renderer.add_instance_attribute(
            attribute.id, np.ascontiguousarray(attribute.values[_order(flat)], np.float32)
        )


def _order(flat: NDArray[np.bool_]) -> NDArray[np.int64]:
    return np.flatnonzero(~flat)[::-1]


def instance_order(scene: Scene) -> NDArray[np.int64]:
    """The instances that the renderer has, in its order, as indices of the scene's."""
    return _order(_is_flat(scene))


def find_flat(scene: Scene) -> NDArray[np.bool_]:
    """(I,) which instances a scale of 0 flattens. The renderer gets none of them; `scene` gets
    warnings.
    """
    instances = scene.instances
    flat = _is_flat(scene)
    for name in sorted({scene.meshes[m].name for m in instances.mesh[flat]}):
        scene.warnings.append(
            f"Mesh '{name}' stands in the scene flattened to nothing (a scale of 0); those "
            "instances are left out."
        )
    return flat


def _is_flat(scene: Scene) -> NDArray[np.bool_]:
    flat: NDArray[np.bool_] = (
        np.linalg.det(scene.instances.matrix[:, :3, :3].astype(np.float32)) == 0
    )
    return flat


def lights_in_surfaces(renderer: Renderer, scene: Scene) -> list[str]:
    """One warning about lights that lie in the plane of a surface: how much of their light gets
    past it is decided by rounding.
    """
    added = np.flatnonzero(~_is_flat(scene))[::-1]

    def mesh(instance: int) -> str:
        return scene.meshes[scene.instances.mesh[added[instance]]].name

    pairs = [
        f"'{scene.lights[lamp].name if lamp >= 0 else mesh(emissive)}' in '{mesh(instance)}'"
        for lamp, emissive, instance in renderer.lights_in_surfaces
    ]
    if not pairs:
        return []
    named = ", ".join(pairs[:3]) + (f" and {len(pairs) - 3} more" if len(pairs) > 3 else "")
    return [
        f"Lights lie exactly in a surface ({named}), which keeps back a part of their light "
        "by chance: move them off it."
    ]


def add_mesh_shading(renderer: Renderer, index: int, mesh: Mesh) -> None:
    for attribute in mesh.shading.attributes:
        renderer.add_mesh_attribute(
            index, attribute.id, str(attribute.domain), np.ascontiguousarray(attribute.values)
        )
    if mesh.shading.generated is not None:
        renderer.set_generated(
            index, list(mesh.shading.generated.scale), list(mesh.shading.generated.offset)
        )


def _add_grids(renderer: Renderer, index: int, mesh: Mesh, known: dict[int, int]) -> None:
    """`known`: which grids the renderer has, by their ids in Python."""
    for own in mesh.shading.grids:
        grid = own.grid
        if id(grid) not in known:
            background = [*grid.background.tolist(), 0.0, 0.0, 0.0][:4]
            known[id(grid)] = renderer.add_grid(
                np.ascontiguousarray(grid.to_index, np.float64),
                [int(c) for c in grid.lower],
                np.ascontiguousarray(grid.table, np.int32),
                np.ascontiguousarray(grid.values, np.float32),
                background,
            )
        renderer.add_mesh_grid(index, own.id, known[id(grid)])


@contextmanager
def _naming(what: str) -> Iterator[None]:
    """Puts `what` before the message of a ValueError."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{what}: {error}") from error


def _side(side: Side) -> tuple:
    return (
        _rgb(side.base_color),
        side.base_color_texture,
        _rgb(side.emission),
        side.emission_texture,
    )


def _rgb(color: tuple[float, float, float]) -> list[float]:
    return [float(c) for c in color]


def _contiguous(values: NDArray | None, dtype: type) -> NDArray | None:
    return None if values is None else np.ascontiguousarray(values, dtype)
