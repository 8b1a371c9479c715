"""What the interface shows and does: every panel draws, presets set what they say, and warnings
lead to their objects.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.support import stage
from tests.support.blender import in_blender
from tests.support.paths import ROOT


class Layout:
    """Stands for a bpy.types.UILayout: takes everything, and writes down labels and properties."""

    def __init__(self, seen: list[str]) -> None:
        self.seen = seen

    def __getattr__(self, name: str) -> Any:
        if name in {"row", "column", "box", "split"}:
            return lambda **_: self
        return lambda *_, **__: None

    def label(self, text: str = "", **_: Any) -> None:
        self.seen.append(text)

    def prop(self, owner: Any, name: str, **_: Any) -> None:
        assert hasattr(owner, name), f"{owner} has no {name}"
        self.seen.append(name)

    def operator(self, name: str, **_: Any) -> Any:
        self.seen.append(name)
        return type("Properties", (), {})()


def _draw(panel: Any) -> list[str]:
    """Labels and properties that a panel shows, if it shows itself."""
    import bpy

    seen: list[str] = []
    if getattr(panel, "poll", None) is None or panel.poll(bpy.context):
        fake = type("Fake", (), {"layout": Layout(seen)})()
        panel.draw(fake, bpy.context)
    return seen


def _panels() -> list[Any]:
    from photon_splat.blender.panels import farm, motion, render, report, view_layer

    return [
        cls
        for part in (render, farm, motion, view_layer, report)
        for cls in part.CLASSES
        if "_PT_" in cls.__name__
    ]


@pytest.mark.smoke
@in_blender
def test_every_panel_draws_before_and_after_a_render() -> None:
    import bpy

    stage.room()
    stage.world(0.5)
    before = {panel.__name__: _draw(panel) for panel in _panels()}
    assert before["PHOTON_SPLAT_PT_last_render"] == []
    stage.portal()
    bpy.ops.render.render()
    after = {panel.__name__: _draw(panel) for panel in _panels()}
    assert after["PHOTON_SPLAT_PT_last_render"][0].startswith("2 passes in ")
    assert "Light portals" in " ".join(after["PHOTON_SPLAT_PT_approximations"])
    shown = {name for panel in after.values() for name in panel}
    hidden = {"rna_type", "name"}
    for group in (stage.scene().photon_splat, bpy.context.view_layer.photon_splat):
        assert {prop.identifier for prop in group.bl_rna.properties} - hidden <= shown, (
            "settings that no panel shows"
        )


@in_blender
def test_every_setting_says_what_it_does() -> None:
    import bpy

    stage.scene()
    for group in (stage.scene().photon_splat, bpy.context.view_layer.photon_splat):
        for prop in group.bl_rna.properties:
            if prop.identifier not in {"rna_type", "name"}:
                assert len(prop.description) > 15, prop.identifier
                assert prop.name == prop.name.title() or "per" in prop.name or "ID" in prop.name, (
                    prop.name
                )


@pytest.mark.parametrize(("name", "error"), [("Draft", 0.1), ("Good", 0.03), ("Final", 0.015)])
@in_blender
def test_presets(name: str, error: float) -> None:
    import bpy
    from photon_splat.blender.panels import presets

    stage.scene()
    path = ROOT / "addon/blender/presets/photon_splat/render" / f"{name}.py"
    if hasattr(bpy.utils, "register_preset_path"):
        assert str(path.parent) in bpy.utils.preset_paths(presets.FOLDER)
    bpy.ops.script.execute_preset(filepath=str(path), menu_idname="PHOTON_SPLAT_PT_presets")
    settings = stage.scene().photon_splat
    assert settings.error_threshold == pytest.approx(error)
    kept = {
        value.removeprefix("settings.")
        for value in presets.PHOTON_SPLAT_OT_preset_add.preset_values
    }
    assert kept == {
        line.split()[0].removeprefix("settings.")
        for line in path.read_text().splitlines()
        if line.startswith("settings.")
    }
    assert all(hasattr(settings, value) for value in kept)


@in_blender
def test_a_preset_of_ones_own() -> None:
    import bpy
    from photon_splat.blender.panels import presets

    settings = stage.scene().photon_splat
    settings.passes = 77
    bpy.ops.photon_splat.preset_add(name="Mine")
    settings.passes = 5
    (path,) = Path(bpy.utils.user_resource("SCRIPTS", path=f"presets/{presets.FOLDER}")).glob(
        "[Mm]ine.py"
    )
    bpy.ops.script.execute_preset(filepath=str(path), menu_idname="PHOTON_SPLAT_PT_presets")
    assert settings.passes == 77


@in_blender
def test_a_click_on_a_warning_selects_what_it_names() -> None:
    import bpy
    from photon_splat.blender.panels import report

    stage.room()
    one, other = stage.plane("It's one"), stage.plane("Other")
    one.data.materials.clear()
    one.data.materials.append(stage.material("Plain"))
    one.data.materials.append(stage.material("Odd"))
    bpy.context.view_layer.objects.active = other
    name = report.named("Material 'Odd', node 'Fresnel': not supported; base colour is used")
    assert name == ["Odd"]
    assert bpy.ops.photon_splat.select(name=name[0]) == {"FINISHED"}
    assert bpy.context.view_layer.objects.active == one
    assert one.active_material.name == "Odd"
    assert [ob.name for ob in bpy.context.selected_objects] == [one.name]
    assert report.named("Hair of objects is left out: 'Other', 'It's one', 'Gone'") == [
        "Other",
        "It's one",
    ]
    assert bpy.ops.photon_splat.select(name="Other") == {"FINISHED"}
    assert bpy.context.view_layer.objects.active == other
    assert report.named("The picture is noisy") == []
    assert bpy.ops.photon_splat.select(name="Odd\nOther") == {"FINISHED"}
    assert {ob.name for ob in bpy.context.selected_objects} == {one.name, other.name}
    assert bpy.context.view_layer.objects.active == one
    assert bpy.ops.photon_splat.select(name="Nobody") == {"CANCELLED"}
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.photon_splat.select.poll()
    bpy.ops.object.mode_set(mode="OBJECT")


@in_blender
def test_panels_of_blender_know_the_engine_and_forget_it() -> None:
    import bpy
    import photon_splat

    def knowing() -> set[str]:
        found = (
            panel
            for panel in bpy.types.Panel.__subclasses__()
            if "PHOTON_SPLAT" in getattr(panel, "COMPAT_ENGINES", ())
        )
        return {panel.__name__ for panel in found if "photon_splat" not in panel.__module__}

    wanted = {
        "RENDER_PT_color_management",
        "EEVEE_MATERIAL_PT_surface",
        "DATA_PT_camera_dof",
        "DATA_PT_lens",
        "MATERIAL_PT_preview",
    }
    assert wanted <= knowing()
    photon_splat.unregister()
    assert knowing() == set()
    photon_splat.register()
    assert wanted <= knowing()


@in_blender
def test_all_warnings_are_shown_one_a_kind_and_lead_to_all_they_name() -> None:
    import bpy
    from photon_splat.blender import job

    scene = stage.room()
    scene.photon_splat.denoise = True
    bpy.context.view_layer.lightgroups.add(name="Lamps")
    for k in range(4):
        thing = stage.plane(f"Thing {k}", location=(0, 0, 0.1 * (k + 1)))
        shade, tree = stage.empty_material(f"Photo {k}")
        shader, photo = (
            tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "TexImage")
        )
        photo.image = bpy.data.images.new(f"{k}.png", 1, 1)
        photo.image.source, photo.image.filepath = "FILE", f"//gone/{k}.png"
        tree.links.new(photo.outputs["Color"], shader.inputs["Color"])
        stage.surface(tree, shader)
        thing.data.materials[0] = shade
    bpy.ops.render.render()
    first, second = job.last_renders[scene.name].warnings
    assert "cannot be read; shown in pink; likewise Material 'Photo " in first
    assert second.startswith("Only Combined is denoised")
    panel = next(cls for cls in _panels() if cls.__name__ == "PHOTON_SPLAT_PT_approximations")
    assert _draw(panel).count("photon_splat.select") == 1
    from photon_splat.blender.panels import report

    assert bpy.ops.photon_splat.select(name="\n".join(report.named(first))) == {"FINISHED"}
    assert {ob.name for ob in bpy.context.selected_objects} == {f"Thing {k}" for k in range(4)}


@in_blender
def test_every_warning_reaches_blenders_reports() -> None:
    from types import SimpleNamespace

    from photon_splat.blender import job

    said: list[str] = []
    engine = SimpleNamespace(
        is_preview=False, update_progress=lambda _: None, report=lambda _, text: said.append(text)
    )
    warnings = [f"Thing {k} is left out" for k in range(5)]
    job._finish(engine, "Odd", SimpleNamespace(statistics={"warnings": warnings}), set())
    assert said == [f"Photon Splat: {warning}" for warning in warnings]
    del job.last_renders["Odd"]
