from tests.integration.addon.conftest import blender

__all__ = ["blender"]
