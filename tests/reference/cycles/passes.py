"""Cases like those of cases.py, of other passes than Combined."""

from __future__ import annotations

from typing import Any

from tests.reference.cycles.cases import Case


def _volume(name: str, build: str = "fog", **options: Any) -> tuple[Case, ...]:
    """The passes of what volumes scatter once, and more often."""
    return tuple(
        Case(
            f"pass_volume_{kind.lower()}_{name}",
            build,
            options,
            samples=512,
            render_pass=f"Volume {kind}",
        )
        for kind in ("Direct", "Indirect")
    )


def _values(name: str, **options: Any) -> Case:
    return Case(
        f"pass_aov_{name}",
        "aovs",
        options,
        samples=256,
        alpha=name == "groups",
        splat=False,
        render_pass="Shown",
    )


def _vector(name: str, build: str = "moving", **options: Any) -> Case:
    balanced = options.get("move") in {"grow", "twist"}  # the mean is about 0
    return Case(
        f"pass_vector_{name}",
        "vectors",
        {"of": build, **options},
        samples=256,
        mean_tolerance=1.0 if balanced else 0.02,
        alpha=True,
        splat=False,
        render_pass="Vector",
    )


def _camera(name: str, **options: Any) -> Case:
    return _vector(f"camera_{name}", "moving_camera", **options)


def _ambient(name: str, **options: Any) -> Case:
    return Case(
        f"pass_ambient_{name}",
        "ambient",
        options,
        samples=512,
        splat=False,
        render_pass="Ambient Occlusion",
    )


PASSES = (
    *_volume("dense", Density=1.5, Color=(0.9, 0.7, 0.4)),
    *_volume("sky", lamp="world", Density=0.6),
    *_volume("cloud", box="cloud", lamp="area", varies=True, Density=12.0),
    *_volume("world", "fog_world", lamp="spot", Density=0.15),
    *_volume("grid", "grid_cloud", lamp="sun", Density=20.0, Anisotropy=0.5),
    _values("groups"),
    _values("value", kind="VALUE"),
    _values("twice", twice=True),
    _values("behind_pane", pane=True),
    _ambient("plain"),
    _ambient("near", distance=0.3),
    _ambient("materials", things="materials"),
    _ambient("pane", things="pane"),
    _ambient("bumps", things="bumps"),
    _ambient("fog", things="fog"),
    _ambient("no_world", things="no_world"),
    _vector("slide"),
    _vector("turn", move="turn"),
    _vector("tumble", move="tumble"),
    _vector("grow", move="grow"),
    _vector("mirrored", move="mirrored"),
    _vector("parent", move="parent"),
    _vector("still", blurred=False),
    _vector("shape", move="shape"),
    _vector("shape_ball", move="shape", shape="ball"),
    _vector("shape_still", move="shape", shape="ball", deform=False),
    _vector("twist", move="twist"),
    _vector("velocity", move="velocity", shape="ball"),
    _vector("displaced", "moving_displaced"),
    _vector("displaced_shape", "moving_displaced", move="shape"),
    _vector("collection", "moving_group"),
    _vector("vertices", "moving_group", kind="vertices"),
    _vector("pane", pane=True),
    _vector("film", film=True),
    _vector("strands", "strands", moves="slide"),
    _vector("strands_velocity", "strands", moves="velocity"),
    _vector("strands_points", "strands", kind="points", moves="velocity"),
    _vector("strands_hair", "strands", kind="hair", moves="bend"),
    _camera("slide"),
    _camera("turn", move="turn"),
    _camera("zoom", move="zoom"),
    _camera("with_thing", thing=True),
    _camera("orthographic", kind="ORTHO"),
    _camera("orthographic_turn", kind="ORTHO", move="turn"),
    _camera("focus", fstop=0.1),
    _camera("panorama", kind="PANO"),
    _camera("fisheye", kind="PANO", panorama="FISHEYE_EQUIDISTANT"),
    _camera("equisolid", kind="PANO", panorama="FISHEYE_EQUISOLID"),
    _camera("polynomial", kind="PANO", panorama="FISHEYE_LENS_POLYNOMIAL"),
    _camera("mirror_ball", kind="PANO", panorama="MIRRORBALL"),
    _camera("cube_face", kind="PANO", panorama="EQUIANGULAR_CUBEMAP_FACE"),
    _camera("cylinder", kind="PANO", panorama="CENTRAL_CYLINDRICAL"),
)
