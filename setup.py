"""The folder addon/ is the package photon_splat; the rest of the packaging is in pyproject.toml."""

from setuptools import find_packages, setup

folders = find_packages(include=["addon", "addon.*"])
setup(packages=["photon_splat" + folder.removeprefix("addon") for folder in folders])
