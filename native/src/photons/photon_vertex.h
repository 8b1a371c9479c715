// A surface with a program as a photon meets it.
#pragma once

#include "photons/photon_tracer.h"

namespace photon_splat {

// A surface with a program where a photon meets it, and its closures for light that comes from
// there.
struct PhotonTracer::Vertex {
  Vertex(const Path& path, const Surface& at, const PhotonStart& from, const Vec3& way)
      : hit(at),
        start(from),
        direction(way),
        direct(path.bounces == 0),
        by_shadow(straight(path, from)),
        bsdf(Transport::kFlux, -way, at.ng, at.ns, at.back) {}

  bool has(uint32_t features) const { return hit.program->features & features; }
  Receiver receiver(const Scene& scene, const Vec3& normal, bool sharp) const {
    return {hit.position, normal, sharp, scene.instances[hit.instance].group};
  }

  const Surface& hit;
  const PhotonStart& start;
  const Vec3 direction;
  const bool direct;     // nothing has scattered the light
  const bool by_shadow;  // a light sample looks back along the way
  RayInfo ray;           // by which the surface is seen from where the photon goes
  float chance = 1;      // of that kind of ray
  bool asked = false;    // some kinds of rays may see it otherwise than others
  bool told = false;     // its kind matters for where the photon goes
  // Who sees the surface from where the light goes may see other closures, of either side
  bool asked_back = false, sided = false;
  Bsdf bsdf;
  Bsdf::SmoothWays ways;  // through smooth glass, as seen from the other side
};

// Light that goes straight on.
struct PhotonTracer::Passing {
  bool blocking = true;  // the surface is in its way
  Rgb transparency;
  bool asked = false;  // by which kind of ray it is looked back along:
  RayInfo ray;
  float chance = 1;  // of that kind
};

}  // namespace photon_splat
