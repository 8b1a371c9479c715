import bpy

settings = bpy.context.scene.photon_splat

settings.error_threshold = 0.015
settings.passes = 4096
settings.time_limit = 0.0
settings.photons_per_pass = 500_000
settings.max_bounces = 32
settings.viewport_passes = 256
settings.viewport_photons_per_pass = 200_000
