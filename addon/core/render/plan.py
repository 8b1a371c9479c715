"""The scene plan: what a scene needs, in plain words. Only what is provably absent is left out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..scene import NO_PROGRAM, NO_TEXTURE, Scene
from .settings import FinalGather, IndirectLight, Integrator, RenderSettings
from .statistics import Statistics


@dataclass(frozen=True, slots=True)
class Plan:
    """sentences: for the user. flags: component -> whether it runs. A component that does not run
    costs nothing. indirect_light: what brings it.
    """

    sentences: list[str] = field(default_factory=list)
    flags: dict[str, bool] = field(default_factory=dict)
    indirect_light: IndirectLight = IndirectLight.PHOTONS

    def applied_to(self, settings: RenderSettings) -> RenderSettings:
        """`settings` without what the plan leaves out."""
        photons = settings.photons_per_pass if self.flags["photons"] else 0
        return replace(settings, photons_per_pass=photons, occlusion=self.flags["occlusion"])


def make_plan(scene: Scene, settings: RenderSettings) -> Plan:
    """Decides from the scene alone, before anything is rendered."""
    used = np.unique(scene.instances.material_set)
    materials = [
        scene.materials[m]
        for m in sorted({int(m) for s in used for m in scene.material_sets[int(s)]})
    ]
    sides = [side for material in materials for side in (material.front, material.back)]
    lamps = [light for light in scene.lights if any(light.strength)]
    # a program may reflect, emit and read textures
    programs = any(material.program != NO_PROGRAM for material in materials)
    world = any(scene.world) or bool(scene.sun_discs) or scene.world_program != NO_PROGRAM
    shining = programs or any(any(side.emission) for side in sides)
    white = programs or any(any(side.base_color) for side in sides)
    textures = programs or any(
        t != NO_TEXTURE for side in sides for t in (side.base_color_texture, side.emission_texture)
    )
    splat = settings.integrator is Integrator.SPLAT
    reasons = {
        "Nothing shines: the picture is black, no photons are traced.": not (
            lamps or world or shining
        ),
        "No surface reflects light: no photons are traced.": not white,
        "Only direct light is asked for: no photons are traced.": settings.max_bounces == 0,
        "Photons are switched off.": settings.photons_per_pass == 0,
    }
    why_not = next((sentence for sentence, applies in reasons.items() if applies), "")
    photons = splat and not why_not
    indirect = indirect_light(scene, settings) if photons else IndirectLight.PHOTONS
    gathers = indirect in (IndirectLight.FINAL_GATHER, IndirectLight.FINAL_GATHER_OR_PATHS)
    flags = {
        "photons": photons,
        "world": world,
        "textures": textures,
        "boundary": splat and settings.boundary_correction,
        "occlusion": splat
        and settings.boundary_correction
        and settings.occlusion
        and len(scene.instances.mesh) > 0,
        "adaptive_radius": splat and settings.adaptive_radius,
        "adaptive_samples": splat and settings.adaptive_samples,
        "adaptive_indirect": settings.adaptive_indirect and photons,
        "final_gather": gathers,
    }
    sentences = []
    if not splat:
        sentences.append("The path tracer does everything: no photons.")
    elif why_not:
        sentences.append(why_not)
    if not world:
        sentences.append("The world is black: no light comes from it.")
    if not textures:
        sentences.append("No textures: nothing is looked up.")
    if splat and not settings.boundary_correction:
        sentences.append("The boundary correction is switched off: edges and corners will be dark.")
    elif splat and not settings.occlusion:
        sentences.append("The occlusion test is switched off: contacts will be dark.")
    if splat and not settings.adaptive_radius:
        sentences.append("Adaptive radii are switched off.")
    if splat and not settings.adaptive_samples:
        sentences.append("Adaptive samples are switched off.")
    if splat and not settings.caustics:
        sentences.append("Caustic photons are switched off: caustics are blurred like other light.")
    if gathers:
        sentences.append(
            "Final gathering: camera paths take one more bounce before photons light them."
        )
    elif _of_few_bounces(scene) and _asks_gather(settings):
        sentences.append(
            "No final gathering: photons of lights of few bounces count from the surface they "
            "light."
        )
    if splat and not settings.adaptive_indirect:
        sentences.append(
            "Paths from the camera never stand in for photons: small things may be blotchy."
        )
    if scene.shutter is not None:
        sentences.append(f"While the shutter is open {_moving(scene)}.")
    return Plan(sentences, flags, indirect)


def _moving(scene: Scene) -> str:
    """What is blurred, as the end of a sentence."""
    instances = len(scene.instances.motion)
    shapes = sum(mesh.moves for mesh in scene.meshes)
    said = []
    if instances:
        said.append("1 instance moves" if instances == 1 else f"{instances:,} instances move")
    if shapes:
        said.append("1 mesh changes" if shapes == 1 else f"{shapes:,} meshes change")
        said[-1] += " in shape"
    if scene.camera.motion is not None:
        said.append("the camera moves")
    return ", ".join(said)


def indirect_light(scene: Scene, settings: RenderSettings) -> IndirectLight:
    """What brings indirect light where there are photons. Only make_plan() asks."""
    if _asks_gather(settings):
        if _of_few_bounces(scene):
            return IndirectLight.PHOTONS
        if settings.final_gather == FinalGather.ON:
            return IndirectLight.FINAL_GATHER
        return IndirectLight.FINAL_GATHER_OR_PATHS
    if settings.denoise or settings.final_gather != FinalGather.AUTO:
        return IndirectLight.PHOTONS
    # Photons take more off the noise the longer a render is; of light that media scatter they may
    # bring little.
    limited = settings.time_limit or settings.error_threshold
    if not limited and not _has_media(scene):
        return IndirectLight.PHOTONS
    if settings.caustics and not _of_few_bounces(scene):
        return IndirectLight.ANY
    return IndirectLight.PHOTONS_OR_PATHS


def _has_media(scene: Scene) -> bool:
    return scene.world_volume != NO_PROGRAM or any(
        material.volume != NO_PROGRAM for material in scene.materials
    )


def _of_few_bounces(scene: Scene) -> bool:
    """Whether photons of some light count from the surface that it lights on, as they do not with
    final gathering.
    """
    return any(light.max_bounces is not None for light in scene.lights)


def _asks_gather(settings: RenderSettings) -> bool:
    """Final gathering trades the kernel's blur for noise, which a denoiser removes. It needs
    caustics to have photons of their own.
    """
    if settings.final_gather == FinalGather.AUTO:
        return settings.denoise and settings.caustics
    return settings.final_gather == FinalGather.ON


def pilot_sentences(statistics: Statistics) -> list[str]:
    """What was found while rendering, in sentences for the user."""
    sentences = []
    photons, discs = statistics["photons"], statistics["discs"]
    if photons["traced"] and "caustic" not in photons:
        sentences.append("No mirror, gloss or glass: no caustic photons.")
    maps = (photons.get("indirect"), photons.get("caustic"))
    if any(counts["guided"] for counts in maps if counts):
        sentences.append("Few photons end in view: emission is guided to those that do.")
    reused = statistics["reused"]
    if reused["geometry"]:
        sentences.append(
            f"Persistent data: geometry and {reused['photons']:,} photons of earlier renders have "
            "been used again."
        )
    if discs["points"]:
        cut = f"{100 * discs['cut'] / max(discs['measured'], 1):.2g} %"
        things = f"{100 * discs['obstructed'] / discs['points']:.2g} %"
        sentences.append(
            f"Surface edges cut {cut} of the discs."
            if discs["cut"]
            else "No surface edge comes near a disc."
        )
        sentences.append(
            f"Things or walls stand in {things} of the discs."
            if discs["obstructed"]
            else "Nothing stands in a disc."
        )
    if statistics["path_traced"]["world"]:
        sentences.append(
            "The world asks how often rays have bounced: paths from the camera bring all of its "
            "light, photons that of lamps alone."
        )
    if statistics["path_traced"]["gathers_after_all"]:
        sentences.append(
            "Few photons end in view: camera paths take one more bounce before photons light them."
        )
    share = statistics["path_traced"]["share"]
    if statistics["path_traced"]["everywhere"]:
        sentences.append(
            "Paths from the camera bring all of the indirect light, at less work here than "
            "photons would; caustics excepted."
        )
    elif share:
        sentences.append(
            f"Too few photons reach {100 * share:.2g} % of the gather points: paths from the "
            "camera go on there."
        )
    return sentences
