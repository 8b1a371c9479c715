"""The splatter on graphics cards, here by software OpenGL."""
