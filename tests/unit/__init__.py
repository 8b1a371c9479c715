"""Single parts of the core, without Blender."""
