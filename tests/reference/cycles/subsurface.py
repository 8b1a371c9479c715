"""Cases like those of cases.py: bodies that light goes into, and leaves elsewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from tests.reference.cycles.cases import Case


def _body(name: str, build: str = "body", **options: Any) -> Case:
    return Case(f"body_{name}", build, options, samples=256)


GREY = (1.0, 1.0, 1.0)

SUBSURFACE = (
    # Lights and sizes
    _body("walk"),
    _body("walk_sun", lamp="sun"),
    _body("walk_world", lamp="world"),
    _body("walk_back", lamp="back", Subsurface_Scale=0.5),
    _body("walk_away", lamp="away"),
    _body("walk_little", Subsurface_Scale=0.005),
    _body("walk_much", Subsurface_Scale=1.0),
    _body("walk_grey", Subsurface_Radius=GREY, Subsurface_Scale=0.2),
    _body("walk_white", Base_Color=(1.0, 1.0, 1.0), Subsurface_Radius=GREY),
    _body("walk_dark", Base_Color=(0.02, 0.1, 0.3), Subsurface_Radius=GREY),
    _body("walk_one_channel", Subsurface_Radius=(1.0, 0.0, 0.0)),
    # How light enters and scatters
    _body("walk_ior", IOR=1.1),
    _body("walk_ior_high", IOR=2.5),
    _body("walk_smooth", Roughness=0.0),
    _body("walk_rough", Roughness=1.0),
    _body("walk_forward", Subsurface_Anisotropy=0.8, Subsurface_Scale=0.05),
    _body("walk_backward", Subsurface_Anisotropy=-0.6),
    _body("walk_matte", Specular_IOR_Level=0.0),
    _body("walk_coat", Coat_Weight=1.0, Coat_Tint=(0.9, 0.6, 0.4)),
    # The other methods
    _body("legacy", method="RANDOM_WALK_LEGACY", Subsurface_Scale=0.8),
    _body("legacy_forward", method="RANDOM_WALK_LEGACY", Subsurface_Anisotropy=0.7),
    _body("skin", method="RANDOM_WALK_SKIN", Subsurface_Scale=0.2),
    _body("skin_ior", method="RANDOM_WALK_SKIN", Subsurface_IOR=2.0, Subsurface_Anisotropy=0.5),
    _body("burley", method="BURLEY", Subsurface_Scale=0.8),
    _body("burley_box", shape="box", method="BURLEY", Subsurface_Scale=1.0, lamp="sun"),
    _body("burley_slab", shape="slab", method="BURLEY", Subsurface_Scale=1.0, lamp="back"),
    _body("node", node="subsurface", Roughness=0.3),
    _body("node_skin", node="subsurface", method="RANDOM_WALK_SKIN"),
    _body("node_burley", node="subsurface", method="BURLEY", Scale=0.5),
    # Shapes
    _body("box", shape="box", lamp="back", Subsurface_Scale=0.3),
    _body("slab", shape="slab", lamp="back"),
    _body("sheet", shape="sheet"),
    _body("thin_wall", shape="sheet", lamp="back", Thin_Wall=True, Subsurface_Anisotropy=0.3),
    _body(
        "thin_wall_half",
        shape="sheet",
        Thin_Wall=True,
        Subsurface_Weight=0.5,
        Subsurface_Anisotropy=-0.5,
    ),
    replace(_body("shell", shape="shell", lamp="inside"), samples=1024, photons_per_pass=80_000),
    _body("monkey", shape="monkey", lamp="sun", Subsurface_Scale=0.05),
    _body("stretched", scale=(1.3, 0.6, 0.9)),
    _body("instances", "bodies"),
    # Textures
    _body("color_texture", texture="Base Color"),
    _body("radius_texture", texture="Subsurface Radius", Subsurface_Scale=0.2),
    _body("weight_texture", texture="Subsurface Weight"),
    _body("half", share=0.5),
    _body("half_transparent", Alpha=0.5),
    _body("half_weight", Subsurface_Weight=0.5, Diffuse_Roughness=0.6),
    _body("bump", bump=True),
)
