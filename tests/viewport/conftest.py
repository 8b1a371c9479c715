from tests.addon.conftest import blender

__all__ = ["blender"]
