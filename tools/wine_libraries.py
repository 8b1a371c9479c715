"""Where the Windows module finds Embree and Open Image Denoise: beside a Blender's executable, in
an installed bpy package; and what is said where there is neither.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from wine import inside
from wine_trial import Trial

ASK = """
import ctypes, json
from photon_splat.core.native import library
from photon_splat.core.native.blender_libraries import DENOISER, EMBREE
from photon_splat.core.render import denoise

kernel32 = ctypes.WinDLL("kernel32")
kernel32.GetModuleHandleW.restype = ctypes.c_void_p
kernel32.GetModuleFileNameW.argtypes = [ctypes.c_void_p, ctypes.c_wchar_p, ctypes.c_ulong]

def place(load, name):
    try:
        load()
    except (ImportError, denoise.DenoiserMissing) as error:
        return str(error)
    path = ctypes.create_unicode_buffer(32768)
    kernel32.GetModuleFileNameW(kernel32.GetModuleHandleW(name), path, len(path))
    return path.value

found = {"Embree": place(library.load, EMBREE), "OIDN": place(denoise._library, DENOISER)}
print(json.dumps(found))
"""
NOWHERE = {
    "Embree": "Photon Splat needs the Embree 4 that Blender ships, but neither this process nor an "
    "installed bpy package has embree4.dll.",
    "OIDN": "the denoiser needs OpenImageDenoise.dll, which Blender ships and which has not been "
    "found here",
}


def libraries(trial: Trial) -> dict[str, Any]:
    wine, blender, numpy = trial.wine, trial.out / "blender", trial.out / "numpy"
    link((file for file in wine.runtime.iterdir() if file.is_file()), blender)
    link((wine.site / "bpy").glob("*.dll"), blender / "blender.shared")
    link(wine.site.glob("numpy*"), numpy)
    shared, package = inside(blender / "blender.shared"), inside(wine.site / "bpy")
    cases = {
        "nowhere": (wine.runtime, numpy, NOWHERE),
        "beside Blender": (blender, numpy, in_folder(shared)),
        "in bpy": (wine.runtime, wine.site, in_folder(package)),
    }
    seconds = 0.0
    for name, (home, packages, expected) in cases.items():
        path = [trial.product, packages]
        taken = trial.run(name, "-c", ASK, path=path, program=home / "python.exe")
        if taken is None:
            continue
        seconds += taken
        if trial.answer(name) != expected:
            trial.fail(f"libraries {name}: {trial.answer(name)}, not {expected}")
    return {"seconds": seconds}


def in_folder(folder: str) -> dict[str, str]:
    return {"Embree": f"{folder}\\embree4.dll", "OIDN": f"{folder}\\OpenImageDenoise.dll"}


def link(files: Iterable[Path], folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    for file in files:
        (folder / file.name).symlink_to(os.path.relpath(file, folder))
