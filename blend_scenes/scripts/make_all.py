"""Makes every scene of blend_scenes anew: `python -m blend_scenes.scripts.make_all`.

Run it with the oldest Blender that must open the files: newer ones read them, not the other way
round.
"""

from blend_scenes.scripts import (
    car,
    caustic_glass,
    caustic_pool,
    caustic_ring,
    chapel,
    classroom,
    cloudy_pool,
    cornell_box,
    fog_lens,
    instances,
    interior,
    kitchen,
    light_types,
    many_lights,
    perfume,
    small_glass,
    staircase,
    street,
    village,
)

cornell_box.make("cornell_box", 0)
cornell_box.make("cornell_box_1500", 3)
cornell_box.make("cornell_box_100k", 6)
interior.make()
instances.make()
light_types.make()
many_lights.make()
for textured in (kitchen, perfume, street, car, village, staircase, classroom):
    textured.make()
for caustics in (
    caustic_glass,
    caustic_ring,
    caustic_pool,
    small_glass,
    fog_lens,
    cloudy_pool,
    chapel,
):
    caustics.make()
