"""The archive of `make extension`, installed as a user does, in a Blender that has nothing else of
ours.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.paths import ROOT

ARCHIVES = sorted(
    Path(os.environ.get("PHOTON_SPLAT_DIST", ROOT / "dist")).glob("photon_splat-*-linux_x64.zip")
)
SHIPPED = ("numpy", "embree", "tbb", "OpenImageIO", "oiio", "bpy")
"""Parts of the names of what Blender has already."""

pytestmark = [
    pytest.mark.smoke,
    pytest.mark.skipif(
        not ARCHIVES, reason="there is no archive in dist/: make extension builds it"
    ),
]


@pytest.fixture(scope="session")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of packages that holds what Blender brings along, and nothing else."""
    folder = tmp_path_factory.mktemp("bare")
    for name in ("bpy", "numpy"):
        spec = importlib.util.find_spec(name)
        assert spec is not None
        assert spec.origin is not None
        package = Path(spec.origin).parent
        for entry in (package, package.with_name(f"{name}.libs")):
            if entry.exists():
                (folder / entry.name).symlink_to(entry)
    return folder


@pytest.fixture(scope="session")
def found(bare: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What tests/integration/extension/install.py says, with the pictures that it rendered."""
    folder = tmp_path_factory.mktemp("installed")
    done = run(bare, folder, f"tests/integration/extension/install.py {ARCHIVES[-1]} {folder}")
    answer = json.loads(done)
    answer["folder"] = str(folder)
    answer["pictures"] = [np.load(folder / f"{name}.npy") for name in ("first", "second")]
    return answer


def run(bare: Path, folder: Path, script: str) -> str:
    environment = {
        key: value
        for key, value in os.environ.items()
        if not key.startswith(("PYTHON", "LD_", "BLENDER_"))
    }
    environment |= {
        "PYTHONPATH": str(bare),
        "BLENDER_USER_RESOURCES": str(folder / "blender"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [sys.executable, "-S", *script.split()]
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


def test_it_comes_from_the_user_folder_alone(found: dict[str, Any]) -> None:
    extensions = f"{found['folder']}/blender/extensions/"
    assert found["installed"] == ["FINISHED"]
    assert found["package"] == f"{extensions}user_default/photon_splat/__init__.py"
    for name in ("native", "moderngl"):
        assert found[name].startswith(f"{extensions}.local/"), found[name]


def test_it_registers_and_leaves_nothing(found: dict[str, Any]) -> None:
    assert found["before"] == found["disabled"] == found["disabled again"] == []
    enabled = found["enabled"]
    assert {
        "RenderEngine PhotonSplatEngine",
        "PropertyGroup PhotonSplatSettings",
        "engine of RENDER_PT_color_management",
    } <= set(enabled)


def test_it_renders_the_picture_of_the_checkout(found: dict[str, Any], tmp_path: Path) -> None:
    """The same bits, after it was disabled and enabled again too."""
    code = (
        "import photon_splat, sys; photon_splat.register(); from "
        "tests.integration.extension.install "
        "import render; render(sys.argv[1])"
    )
    environment = os.environ | {"BLENDER_USER_RESOURCES": str(tmp_path / "blender")}
    path = tmp_path / "checkout.npy"
    subprocess.run(
        [sys.executable, "-c", code, path],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        check=True,
    )
    expected = np.load(path)
    assert expected.mean() > 0.05
    for picture in found["pictures"]:
        assert np.array_equal(picture, expected)


def test_the_archive_bundles_nothing_of_blender() -> None:
    with zipfile.ZipFile(ARCHIVES[-1]) as archive:
        names = archive.namelist()
        wheels = [name for name in names if name.endswith(".whl")]
        for wheel in wheels:
            inside = zipfile.ZipFile(archive.open(wheel)).namelist()
            names += inside
            if "photon_splat_native" in wheel:
                stub, module = sorted(name for name in inside if ".dist-info/" not in name)
                assert re.fullmatch(r"photon_splat_native_\d+_\d+_\d+\.\S+\.so", module)
                assert stub.endswith(".pyi")
    assert not [name for name in names if any(part.lower() in name.lower() for part in SHIPPED)]
    assert {re.match(r"wheels/(\w+)-", wheel)[1] for wheel in wheels} == {
        "photon_splat_native",
        "moderngl",
        "glcontext",
    }  # type: ignore[index]
    here = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    assert any(here in wheel for wheel in wheels)
    assert {"blender_manifest.toml", "__init__.py", "shaders/splat.vert", "LICENSE"} <= set(names)
    assert not [
        name for name in names if "__pycache__" in name or name.startswith(("tests/", "native/"))
    ]
