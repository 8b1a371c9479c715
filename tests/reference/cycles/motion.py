"""Cases like those of cases.py: things, cameras and shutters that motion blur is about."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case


def _case(name: str, build: str, *, splat: bool = False, **options: Any) -> Case:
    return Case(
        f"motion_{name}",
        build,
        options,
        samples=1024,
        block_bias=0.04,
        alpha=bool(options.get("film")),
        splat=splat,
    )


def _moving(name: str, *, splat: bool = False, **options: Any) -> Case:
    return _case(name, "moving", splat=splat, **options)


def _camera(name: str, *, splat: bool = False, **options: Any) -> Case:
    return _case(f"camera_{name}", "moving_camera", splat=splat, **options)


MOTION = (
    # Transforms
    _moving("slide", splat=True),
    _moving("slide_sun", light="SUN", splat=True),
    _moving("slide_sky", light="world", splat=True),
    _moving("turn", move="turn", splat=True),
    _moving("tumble", move="tumble", material="object"),
    _moving("tumble_many_steps", move="tumble", material="object", steps=3),
    _moving("grow", move="grow", splat=True),
    _moving("mirrored", move="mirrored", material="object", splat=True),
    _moving("parent", move="parent", splat=True),
    _moving("standing", shape="standing", splat=True, move="glide"),
    _moving("tray", shape="tray", splat=True, move="turn"),
    # Shapes
    _moving("shape", move="shape", splat=True),
    _moving("shape_ball", move="shape", shape="ball", material="generated", splat=True),
    _moving("shape_steps", move="shape_late", shape="ball", material="generated", steps=2),
    _moving("shape_twist", move="twist", shape="box"),
    _moving("shape_velocity", move="velocity", shape="ball", material="generated"),
    _moving("shape_still", move="shape", material="generated", deform=False),
    # What it is made of
    _moving("generated", material="generated"),
    _moving("bumpy", material="bumpy", shape="ball", move="turn"),
    _moving("mirror", material="mirror", shape="ball", splat=True),
    _moving("glass", material="glass"),
    _moving("shining", material="shining", splat=True),
    _moving("shining_plate", material="shining", shape="plate", move="mirrored", splat=True),
    _moving("shining_ball", material="shining", shape="ball", move="shape", splat=True),
    _moving("fog", material="fog"),
    _moving("shadow", seen=False, light="POINT", splat=True),
    _moving("film", film=True),
    _case("displaced", "moving_displaced"),
    _case("displaced_shape", "moving_displaced", move="shape"),
    # Instances
    _case("collection", "moving_group", splat=True),
    _case("vertices", "moving_group", kind="vertices"),
    _case("particles", "moving_particles"),
    # Shutters
    _moving("short", length=0.25),
    _moving("long", length=2.0, splat=True),
    _moving("start", position="START"),
    _moving("end", position="END", move="turn", material="object"),
    _moving("opening", curve="opening", splat=True),
    _moving("closing", curve="closing", move="turn"),
    _moving("rolling", rolling=0.0),
    _moving("rolling_lines", rolling=0.3),
    _moving("off", blurred=False),
    _moving("still", move="none"),
    # Cameras and lamps
    _camera("slide", splat=True),
    _camera("turn", move="turn"),
    _camera("zoom", move="zoom"),
    _camera("zoom_opening", move="zoom", curve="opening"),
    _camera("orthographic", kind="ORTHO"),
    _camera("panorama", kind="PANO"),
    _camera("focus", fstop=0.1),
    _camera("with_thing", thing=True, splat=True),
    _camera("off", blurred=False, thing=True),
    _camera("rolling", move="turn", rolling=0.1),
    _case("lamp", "moving_lamp"),
    _case("lamp_start", "moving_lamp", position="START"),
)
