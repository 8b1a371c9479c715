"""Registering and forgetting the engine: at any time, in any order, also after files, undo and
reloaded scripts.
"""

from __future__ import annotations

from typing import Any

import pytest

from tests.support import stage
from tests.support.blender import in_blender


def _ours() -> list[str]:
    """What Blender holds of the engine."""
    import bpy

    found = [
        f"{name}: {handler.__qualname__}"
        for name in dir(bpy.app.handlers)
        if isinstance(getattr(bpy.app.handlers, name), list)
        for handler in getattr(bpy.app.handlers, name)
        if handler.__module__.startswith("photon_splat")
    ]
    found += [name for name in dir(bpy.types) if name.startswith(("PHOTON_SPLAT", "PhotonSplat"))]
    found += [
        f"{owner.__name__}.photon_splat"
        for owner in (bpy.types.Scene, bpy.types.ViewLayer)
        if hasattr(owner, "photon_splat")
    ]
    return sorted(found)


def _parts() -> list[Any]:
    from photon_splat.blender import engine, panels, persistent, viewport
    from photon_splat.blender import properties as settings

    return [settings, viewport, persistent, engine, panels]


@pytest.mark.smoke
@in_blender
def test_removing_after_a_file_was_opened_and_all_handlers_are_gone(tmp_path: str) -> None:
    import bpy
    import photon_splat

    whole = _ours()
    assert whole
    bpy.ops.wm.save_as_mainfile(filepath=f"{tmp_path}/a.blend")
    bpy.ops.wm.open_mainfile(filepath=f"{tmp_path}/a.blend")
    assert _ours() == whole
    for name in dir(bpy.app.handlers):
        handlers = getattr(bpy.app.handlers, name)
        if isinstance(handlers, list):
            handlers.clear()
    try:
        photon_splat.unregister()
        assert _ours() == []
    finally:
        photon_splat.register()
    assert _ours() == whole


@in_blender
def test_what_is_told_of_a_file_is_forgotten_with_it() -> None:
    import bpy
    from photon_splat.blender import job

    stage.room()
    for _ in range(2):
        bpy.ops.render.render()
        assert job.last_renders
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        assert not job.last_renders
        stage.room()
        bpy.context.scene.render.engine = "PHOTON_SPLAT"


@in_blender
def test_registering_and_removing_in_any_order() -> None:
    import photon_splat

    whole = _ours()
    try:
        photon_splat.register()  # again
        assert _ours() == whole
        for part in _parts():  # the wrong way round
            part.unregister()
        assert _ours() == []
        photon_splat.unregister()
        photon_splat.unregister()
        for part in _parts():
            part.register()
        for part in _parts():
            part.register()
        assert _ours() == whole
    finally:
        photon_splat.register()


@in_blender
def test_scripts_that_are_reloaded_leave_nothing_twice() -> None:
    """What Blender's Reload Scripts does, also where the old scripts could not remove
    themselves.
    """
    import importlib
    import sys

    import photon_splat

    whole = _ours()
    try:
        for removes in (True, False):
            if removes:
                photon_splat.unregister()
            held = {
                name: sys.modules.pop(name)
                for name in list(sys.modules)
                if name.startswith("photon_splat.")
            }
            for name in held:
                vars(photon_splat).pop(name.split(".")[1], None)
            try:
                importlib.reload(photon_splat).register()
                assert _ours() == whole
                photon_splat.unregister()
                assert _ours() == []
            finally:
                for name in [name for name in sys.modules if name.startswith("photon_splat.")]:
                    del sys.modules[name]
                sys.modules.update(held)
                for name, module in held.items():
                    if name.count(".") == 1:
                        setattr(photon_splat, name.rpartition(".")[2], module)
            photon_splat.register()
    finally:
        photon_splat.register()


@in_blender
def test_a_fault_while_registering_leaves_nothing() -> None:
    import photon_splat
    from photon_splat.blender import panels

    whole = _ours()
    photon_splat.unregister()
    plain = panels.register
    try:
        panels.register = lambda: [][0]
        with pytest.raises(IndexError):
            photon_splat.register()
        assert _ours() == []
    finally:
        panels.register = plain
        photon_splat.register()
    assert _ours() == whole
