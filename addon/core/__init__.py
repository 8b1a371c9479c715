"""The renderer without Blender: scene description, render session, film and statistics. Imports no
bpy.
"""
