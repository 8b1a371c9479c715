"""The folder addon/ is the package photon_splat, with shaders/ inside; the rest of the packaging is
in pyproject.toml.
"""

import tomllib
from pathlib import Path

from setuptools import find_packages, setup

manifest = tomllib.loads(Path("addon/blender_manifest.toml").read_text(encoding="utf-8"))

folders = find_packages(include=["addon", "addon.*"])
setup(
    version=manifest["version"],
    packages=["photon_splat" + folder.removeprefix("addon") for folder in folders]
    + ["photon_splat.shaders"],
    package_dir={"photon_splat": "addon", "photon_splat.shaders": "shaders"},
    package_data={
        "photon_splat": ["blender_manifest.toml", "blender/presets/**/*.py"],
        "photon_splat.shaders": ["*"],
    },
)
