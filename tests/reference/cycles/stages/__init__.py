"""Builds the scenes of cases in Blender."""
