"""The scenes of the project and the scripts that make them: `python -m blend_scenes.make_all`."""
