"""Blender's shader node trees -> core.shading.Program."""
