"""Shader node trees of Blender, compiled to programs that native code runs at every hit."""
