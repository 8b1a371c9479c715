"""Which Embree the native module binds to, and what is said when it is missing or of another
version.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

RunPython = Callable[..., subprocess.CompletedProcess[str]]
pytestmark = pytest.mark.smoke

LOAD = "from photon_splat.core.native.library import load; load()"
MAPPED = (
    "print(*sorted({line.split()[-1] for line in open('/proc/self/maps') if 'libembree' in line}))"
)
REPORT_ERROR = f"""
try:
    {LOAD}
except ImportError as error:
    print(error)
"""

TINY_RENDER = """
import numpy as np
from photon_splat.core.scene import (
    Camera, Frame, Instances, Light, LightKind, Material, Mesh, Scene
)
from photon_splat.core.render.session import render
from photon_splat.core.render.settings import RenderSettings
import time

corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
floor = Mesh("floor", corners, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
lamp = np.eye(4)
lamp[2, 3] = 1.0
eye = np.eye(4)
eye[2, 3] = 2.0
scene = Scene(
    camera=Camera(matrix=eye, screen=(-0.9, 0.9, -0.9, 0.9), orthographic=True),
    frame=Frame(8, 8),
    meshes=[floor],
    instances=Instances(np.zeros(1, np.uint32), np.eye(4)[None], np.zeros(1, np.uint32)),
    material_sets=[np.zeros(1, np.int32)],
    materials=[Material("grey")],
    lights=[Light("lamp", LightKind.POINT, lamp, (10.0, 10.0, 10.0))],
)
settings = RenderSettings(passes=2, photons_per_pass=1000, threads=2)
picture = render(scene, settings, started=time.monotonic()).passes["Combined"]
assert np.isfinite(picture).all()
assert picture[..., :3].mean() > 0.01, picture[..., :3].mean()
"""


def succeed(process: subprocess.CompletedProcess[str]) -> str:
    assert process.returncode == 0, process.stderr
    return process.stdout.strip()


@pytest.mark.parametrize(
    "code",
    [LOAD, f"import bpy; {LOAD}", f"{LOAD}; import bpy"],
    ids=["core alone", "bpy first", "bpy after"],
)
def test_binds_to_the_embree_of_bpy(run_python: RunPython, bpy_lib: Path, code: str) -> None:
    assert Path(succeed(run_python(f"{code}\n{MAPPED}"))).parent == bpy_lib


def test_renders_without_bpy(run_python: RunPython) -> None:
    succeed(run_python(TINY_RENDER))


def test_renders_with_blenders_libraries_in_the_global_scope(
    run_python: RunPython, bpy_lib: Path, module_path: Path
) -> None:
    """A Blender executable has these libraries in the scope that every symbol is looked up in
    first.
    """
    libraries = [
        bpy_lib / "libembree4.so.4",
        bpy_lib / "libtbb.so.12",
        *sorted(bpy_lib.glob("libOpenImageIO*.so.*")),
    ]
    assert len(libraries) >= 4
    preload = ":".join(str(library) for library in libraries)
    process = run_python(TINY_RENDER + MAPPED, LD_PRELOAD=preload, LD_DEBUG="bindings")
    assert process.stdout.strip() == str(bpy_lib / "libembree4.so.4"), process.stderr[-2000:]

    bound = re.findall(
        rf"binding file \S*/{re.escape(module_path.name)} \[0\] to (\S+) \[0\]: normal symbol "
        rf"`(\S+?)'",
        process.stderr,
    )
    assert "rtcNewDevice" in {symbol for _, symbol in bound}, (
        "LD_DEBUG shows no binding of the module"
    )
    from_blender = {
        (Path(library).name, symbol) for library, symbol in bound if Path(library).parent == bpy_lib
    }
    assert {library for library, _ in from_blender} == {"libembree4.so.4"}, from_blender
    assert all(symbol.startswith("rtc") for _, symbol in from_blender), from_blender


def fake_embree(folder: Path, module_path: Path, version: int, leave_out: str = "") -> Path:
    """A library of Embree's soname with all that the module links to, that says it is of
    `version`.
    """
    undefined = subprocess.run(
        ["nm", "-D", "--undefined-only", module_path], capture_output=True, text=True, check=True
    ).stdout
    functions = {
        line.split()[-1] for line in undefined.splitlines() if line.split()[-1].startswith("rtc")
    }
    assert {"rtcGetDeviceProperty", leave_out or "rtcNewDevice"} <= functions
    functions.discard(leave_out)
    special = {
        "rtcNewDevice": "void *rtcNewDevice(const char *config) { return (void *)config + 1; }",
        "rtcGetDeviceProperty": "long rtcGetDeviceProperty(void *device, int property) { return "
        f"{version}; }}",
    }
    source = folder / "fake_embree.c"
    source.write_text(
        "\n".join(special.get(name, f"void {name}(void) {{}}") for name in sorted(functions))
    )
    library = folder / "libembree4.so.4"
    subprocess.run(
        ["cc", "-shared", "-fPIC", "-w", "-Wl,-soname,libembree4.so.4", "-o", library, source],
        check=True,
    )
    return library


@pytest.mark.parametrize(("version", "said"), [(30904, "3.9.4"), (50000, "5.0.0")])
def test_another_version_is_an_import_error(
    run_python: RunPython, tmp_path: Path, module_path: Path, version: int, said: str
) -> None:
    library = fake_embree(tmp_path, module_path, version)
    message = succeed(run_python(REPORT_ERROR, LD_PRELOAD=str(library)))
    assert message == f"Photon Splat needs Embree 4, but Embree {said} is loaded in this process."


def test_a_library_that_lacks_a_function_is_an_import_error(
    run_python: RunPython, tmp_path: Path, module_path: Path
) -> None:
    library = fake_embree(tmp_path, module_path, 40400, leave_out="rtcNewScene")
    message = succeed(run_python(REPORT_ERROR, LD_PRELOAD=str(library)))
    assert message == (
        "Photon Splat needs the Embree 4 that Blender ships, but the libembree4.so.4 in this "
        "process lacks a function of Embree 4."
    )


def test_no_embree_is_an_import_error(run_python: RunPython) -> None:
    without_bpy = (
        "import photon_splat.core.native.library as native; native.places = lambda name: iter(())"
    )
    message = succeed(run_python(without_bpy + REPORT_ERROR))
    assert message == (
        "Photon Splat needs the Embree 4 that Blender ships, but neither this process nor an "
        "installed bpy package has libembree4.so.4."
    )


def test_no_native_module_is_an_import_error(run_python: RunPython) -> None:
    """One of another version is no better than none."""
    other_version = (
        "import photon_splat.core.native.library as native; native.engine_version = lambda: '9.9.9'"
    )
    message = succeed(run_python(other_version + REPORT_ERROR))
    assert re.fullmatch(
        r"Photon Splat's native module photon_splat_native 9\.9\.9 is not installed for this "
        r"Python \(.+\)\.",
        message,
    )
