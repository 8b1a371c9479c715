"""The splatter that runs on a graphics card, through OpenGL 3.3.

One thread owns the OpenGL context (context.py) and nothing else may touch it: a context that is
current on Blender's thread corrupts Blender's drawing. That thread draws (painter.py); the render's
own thread feeds it (splatter.py).
"""
