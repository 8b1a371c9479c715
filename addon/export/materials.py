"""Blender materials -> core.scene.Material, as a program or, where they come to no more than that,
as two Lambertian sides.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import bpy

from ..core.scene import NO_PROGRAM, Material, Side
from ..core.scene.displacement import UNDISPLACED_NORMALS, Displacement
from ..core.scene.shading import GENERATED, Feature, Program
from .cancelled import Watch
from .images import Textures
from .nodes.aovs import AovOutputs
from .nodes.assemble import statement
from .nodes.compiler import Compiled, Compiler
from .nodes.links import (
    hollow_groups,
    is_linked,
    label,
    output_node,
    report_foreign_output,
    uses_nodes,
)
from .nodes.node import Owner, Surroundings, Wants
from .nodes.reduce import lambertian
from .nodes.trees import Groups, Trees
from .nodes.values import ONE, ORIGIN, ZERO, Folding, Graph, number, vector
from .report import Report

DEFAULT_NAME = "default_surface"
"""As Cycles calls it, in mattes too."""
Key = tuple[int, str | None, bool]
BLACK = Side((0.0, 0.0, 0.0))
PASSES_TWICE = Feature.TRANSPARENT | Feature.TRANSMITS | Feature.SHARP


class Shading:
    """What the trees of one scene share: programs, each once, textures, and what programs ask of
    meshes and instances.
    """

    def __init__(
        self, textures: Textures, report: Report, depsgraph: Any = None, watch: Watch | None = None
    ) -> None:
        self.programs: list[Program] = []
        self.of_vertices: list[Program] = []  # those that move vertices, which no hit runs
        self.around = Surroundings(textures, report, Wants(), Trees(), depsgraph, watch or Watch())
        self.folding = Folding()

    def add(self, program: Program) -> int:
        self.programs.append(program)
        return len(self.programs) - 1

    def tree(self, owner: Any) -> Any:
        """The node tree of a material, light or world as it is compiled."""
        return self.around.trees.inlined.tree(owner)

    def compile(
        self, owner: Owner, surface: Any, displacement: Any = None, displaced: bool = False
    ) -> Compiled:
        return Compiler(owner, self.around, self.folding).surface(surface, displacement, displaced)

    def displacement(self, owner: Owner, socket: Any) -> Compiled | None:
        return Compiler(owner, self.around, self.folding).displacement(socket)

    def pass_value(
        self, owner: Owner, outputs: Sequence[tuple[Any, Groups]], is_color: bool
    ) -> Compiled:
        """What AOV Outputs give together, each with the groups that it is in."""
        return Compiler(owner, self.around, self.folding).pass_value(outputs, is_color)

    @property
    def wanted_of_instances(self) -> frozenset[int]:
        """Ids of what programs read from instances."""
        programs = self.programs + self.of_vertices
        return frozenset[int]().union(*(program.wants_instances for program in programs))

    @property
    def asked_of_displaced(self) -> frozenset[int]:
        """Ids of what programs of surfaces read that is as it was before displacement."""
        wanted = frozenset[int]().union(*(program.wants for program in self.programs))
        return wanted & {UNDISPLACED_NORMALS, GENERATED}


class Materials:
    """The materials of one scene, each once. Indices point into `list`."""

    def __init__(self, shading: Shading, aovs: Sequence[tuple[str, bool]] = ()) -> None:
        self.list: list[Material] = []
        self._aovs = aovs
        self._aov_outputs = AovOutputs()
        self._aov_programs: dict[tuple[int, int], int] = {}  # by pass and material
        self.displacements: dict[int, Displacement] = {}  # of those that move the surface
        self._shading = shading
        self._known: dict[Key, int] = {}
        # materials that are the same for every render-active UV map
        self._any_uv_map: dict[tuple[int, bool], int] = {}

    def index(self, material: Any, uv_map: str | None = None, grids: bool = False) -> int:
        """Index of a bpy.types.Material (None: Blender's default) on an object whose render-active
        UV map is `uv_map`. `grids`: the object stands for volume grids.
        """
        if material is None:
            return self._remember((0, None, False), lambda: default_material(self._shading))
        pointer = material.as_pointer()
        if (pointer, grids) in self._any_uv_map:
            return self._any_uv_map[pointer, grids]
        opaque = not getattr(material, "use_transparent_shadow", True)
        owner = Owner(f"Material '{material.name}'", material, uv_map=uv_map, opaque_shadow=opaque)
        if not grids and (pointer, uv_map, grids) not in self._known:
            displacement = true_displacement(material, owner, self._shading)
            if displacement is not None:
                self.displacements[len(self.list)] = displacement
        index = self._remember(
            (pointer, uv_map, grids),
            lambda: export_material(material, owner, self._shading, grids),
        )
        self.list[index].pass_index = int(material.pass_index)
        self._fill_aovs(index, material, owner)
        kept = getattr(material.original, "cycles", None)
        if not getattr(kept, "use_bump_map_correction", True):
            self._shading.around.report.warn(
                "Bump Map Correction cannot be switched off; it is on in: {}", material.name
            )
        if not owner.asked_uv_map:
            self._any_uv_map[pointer, grids] = index
        return index

    def _fill_aovs(self, index: int, material: Any, owner: Owner) -> None:
        """What the material's own outputs give the passes that the view layer names."""
        for k, (name, is_color) in enumerate(self._aovs):
            if (k, index) in self._aov_programs or not uses_nodes(material):
                continue
            outputs = self._aov_outputs.found(self._shading.tree(material)).get(name)
            if outputs:
                value = self._shading.pass_value(owner, outputs, is_color)
                program = self._shading.add(value.program(f"{material.name} ({name})"))
                self._aov_programs[k, index] = program

    def aov_programs(self) -> list[list[int]]:
        """By pass, of each material."""
        of_materials = [self._aov_programs_of(index) for index in range(len(self.list))]
        return [[found[k] for found in of_materials] for k in range(len(self._aovs))]

    def _aov_programs_of(self, index: int) -> list[int]:
        """By pass."""
        return [self._aov_programs.get((k, index), NO_PROGRAM) for k in range(len(self._aovs))]

    def wanted_of_meshes(self, index: int) -> frozenset[int]:
        """Ids of what a material's programs read from the meshes that have it."""
        material = self.list[index]
        numbers = [material.program, material.volume, *self._aov_programs_of(index)]
        programs = [self._shading.programs[number] for number in numbers if number != NO_PROGRAM]
        if index in self.displacements:
            programs.append(self.displacements[index].program)
        wanted = frozenset[int]().union(*(program.wants for program in programs))
        return wanted - {UNDISPLACED_NORMALS}

    def _remember(self, key: Key, make: Callable[[], Material]) -> int:
        if key not in self._known:
            self.list.append(make())
            self._known[key] = len(self.list) - 1
        return self._known[key]


def default_material(shading: Shading) -> Material:
    """What an object without material looks like: a Principled BSDF from Blender 5.0 on, before
    that a diffuse surface.
    """
    if bpy.app.version < (5, 0, 0):
        return Material(DEFAULT_NAME)
    return Material(DEFAULT_NAME, program=shading.add(_default_program(shading)))


def _default_program(shading: Shading) -> Program:
    white = vector((1.0, 1.0, 1.0))
    zeros: tuple[str, ...] = (
        "metallic",
        "diffuse_roughness",
        "subsurface_weight",
        "anisotropic",
        "anisotropic_rotation",
    )
    zeros += (
        "transmission_weight",
        "coat_weight",
        "sheen_weight",
        "emission_strength",
        "thin_film_thickness",
        "subsurface_scale",
        "subsurface_anisotropy",
        "thin_wall",
    )
    given = dict.fromkeys(zeros, ZERO) | dict.fromkeys(
        ("normal", "coat_normal", "tangent", "subsurface_radius"), ORIGIN
    )
    given |= dict.fromkeys(("specular_tint", "coat_tint", "sheen_tint", "emission_color"), white)
    given |= {
        "weight": ONE,
        "base_color": vector((0.8, 0.8, 0.8)),
        "alpha": ONE,
        "coat_roughness": number(0.03),
    }
    given |= dict.fromkeys(("roughness", "specular_level", "sheen_roughness"), number(0.5))
    given |= dict.fromkeys(("ior", "coat_ior", "subsurface_ior"), number(1.5)) | {
        "thin_film_ior": number(1.33)
    }
    made = statement(
        "Principled", distribution="MULTI_GGX", subsurface_method="RANDOM_WALK", **given
    )
    return Compiled(Graph(shading.folding), [made], Feature.GATHERS | Feature.REST).program(
        DEFAULT_NAME
    )


def displacement_method(material: Any) -> str:
    """BUMP, DISPLACEMENT or BOTH."""
    return str(getattr(material, "displacement_method", "BUMP"))


def true_displacement(material: Any, owner: Owner, shading: Shading) -> Displacement | None:
    """How a material moves the surface itself; None where it does not."""
    method = displacement_method(material)
    output = output_node(shading.tree(material)) if uses_nodes(material) else None
    if method == "BUMP" or output is None or not is_linked(output, "Displacement"):
        return None
    compiled = shading.displacement(owner, output.inputs["Displacement"])
    if compiled is None:
        return None
    program = compiled.program(f"{material.name} (displacement)")
    shading.of_vertices.append(program)
    return Displacement(program, bumps=method == "BOTH")


def export_material(material: Any, owner: Owner, shading: Shading, grids: bool = False) -> Material:
    """Without nodes its viewport colour is what Cycles takes, with an empty tree it is black.
    `grids`: of an object that stands for volume grids.
    """
    report = shading.around.report
    if not uses_nodes(material):
        r, g, b, _ = material.diffuse_color
        side = Side(base_color=(r, g, b))
        return Material(material.name, side, side)
    tree = shading.tree(material)
    output = output_node(tree)
    if output is None:
        report_foreign_output(tree, owner.name, report)
        return Material(material.name, BLACK, BLACK)
    # Blender 5 has taken groups apart in the evaluated tree
    for group in hollow_groups(material.original.node_tree):
        report.warn(
            f"{owner.name}, node '{label(group)}': the group has no output; links from it count "
            "as not there"
        )
    volume = None
    if is_linked(output, "Volume"):
        volume = shading.around.trees.feed(output.inputs["Volume"], ())
    medium = export_volume(
        Owner(
            owner.name,
            material,
            uv_map=owner.uv_map,
            of_volume=True,
            grids=grid_interpolation(material) if grids else None,
        ),
        material.name,
        output,
        shading,
    )
    method = displacement_method(material)
    bumps = is_linked(output, "Displacement") and method != "DISPLACEMENT"
    displacement = output.inputs["Displacement"] if bumps else None
    compiled = shading.compile(owner, output.inputs["Surface"], displacement, method == "BOTH")
    # a volume alone, as in Cycles: its surface is not there
    if compiled.empty and volume is not None and volume.node is not None:
        clear = statement("Transparent", weight=ONE, color=vector((1.0, 1.0, 1.0)))
        compiled = Compiled(compiled.graph, [clear], Feature.TRANSPARENT)
    passes_twice = not owner.opaque_shadow and PASSES_TWICE in compiled.features
    if passes_twice and compiled.knows_shadow_rays():
        report.warn(
            "Light goes straight through (Is Shadow Ray), and as a caustic besides, which Cycles "
            "hardly ever finds: up to twice as bright behind {}",
            material.name,
        )
    sides = _sides(material, owner, compiled, output, shading)
    if sides is not None:
        return Material(material.name, *sides, volume=medium)
    program = shading.add(compiled.program(material.name))
    return Material(material.name, program=program, volume=medium)


def grid_interpolation(material: Any) -> str:
    kept = getattr(material.original, "cycles", None)
    return "CUBIC" if getattr(kept, "volume_interpolation", "") == "CUBIC" else "LINEAR"


def export_volume(owner: Owner, name: str, output: Any, shading: Shading) -> int:
    """Index of the program of the medium that an output node's Volume describes; NO_PROGRAM where
    there is none.
    """
    if not is_linked(output, "Volume"):
        return NO_PROGRAM
    compiled = shading.compile(owner, output.inputs["Volume"])
    if not compiled.statements:
        return NO_PROGRAM
    return shading.add(compiled.program(f"volume of {name}"))


def _sides(
    material: Any, owner: Owner, compiled: Compiled, output: Any, shading: Shading
) -> tuple[Side, Side] | None:
    """The two sides of a material that amounts to Lambertian reflection and emission, else None."""
    if any(made.operation.name not in {"Diffuse", "Emission"} for made in compiled.statements):
        return None
    whole = lambertian(compiled)
    if whole is not None and min(whole[1][0]) < 0.0:
        return None  # programs alone tell light below zero
    if whole is not None:
        side = _side(whole, owner, shading)
        return side, side
    if owner.normal is not None or "Backfacing" not in compiled.operations():
        return None
    found = []
    for back in (False, True):
        one = Owner(owner.name, material, back, owner.uv_map)
        reduced = lambertian(shading.compile(one, output.inputs["Surface"]))
        if reduced is None or min(reduced[1][0]) < 0.0:
            return None
        found.append(_side(reduced, owner, shading))
    return found[0], found[1]


def _side(reduced: Any, owner: Owner, shading: Shading) -> Side:
    (base, base_texture), (emission, emission_texture) = reduced
    if min(base) < 0.0:
        shading.around.report.warn(f"{owner.name}: negative colours are taken as 0")
        base = max(base[0], 0.0), max(base[1], 0.0), max(base[2], 0.0)
    return Side(base, base_texture, emission, emission_texture)
