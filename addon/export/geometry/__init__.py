"""Meshes, strands and volumes: what stands in the scene, and what programs read from it."""
