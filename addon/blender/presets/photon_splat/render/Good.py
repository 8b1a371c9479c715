import bpy

settings = bpy.context.scene.photon_splat

settings.error_threshold = 0.03
settings.passes = 512
settings.time_limit = 0.0
settings.photons_per_pass = 200_000
settings.max_bounces = 32
settings.viewport_passes = 64
settings.viewport_photons_per_pass = 100_000
