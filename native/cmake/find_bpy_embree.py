"""Prints the path of the Embree 4 library inside the installed bpy package, or nothing. bpy itself
is not imported.
"""

import importlib.util
from pathlib import Path

spec = importlib.util.find_spec("bpy")
if spec is not None and spec.origin is not None:
    package = Path(spec.origin).parent
    names = ("lib/libembree4.so.4", "lib/libembree4*.dylib", "lib/embree4.lib", "embree4.lib")
    found = [path for name in names for path in sorted(package.glob(name))]
    if found:
        print(found[0].as_posix())
