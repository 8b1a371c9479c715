"""The add-on inside Blender, the extension and the packages."""
