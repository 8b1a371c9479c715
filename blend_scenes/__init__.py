"""The scenes of the project; scripts/ makes them."""
