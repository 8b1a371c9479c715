"""Adaptive subdivision: meshes in triangles that are as small as a camera wants them."""
