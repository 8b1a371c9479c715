#include "film.h"

#include "parallel.h"

namespace photon_splat {

void add_pass(Film& sum, Film& pass, ThreadPool& pool) {
  if (++sum.passes == 1) {
    sum.pixels.swap(pass.pixels);
    sum.by_group.swap(pass.by_group);
    return;
  }
  const CancelFlag never;  // a sum is never left half done
  pool.for_each(static_cast<size_t>(sum.height), never, [&](size_t row, int) {
    for (size_t i = row * sum.width; i < (row + 1) * sum.width; ++i) {
      Pixel& to = sum.pixels[i];
      const Pixel& from = pass.pixels[i];
      to.diffuse_direct += from.diffuse_direct;
      to.diffuse_indirect += from.diffuse_indirect;
      to.glossy_direct += from.glossy_direct;
      to.glossy_indirect += from.glossy_indirect;
      to.transmission_direct += from.transmission_direct;
      to.transmission_indirect += from.transmission_indirect;
      to.diffuse_color += from.diffuse_color;
      to.albedo += from.albedo;
      to.emission += from.emission;
      to.environment += from.environment;
      to.normal += from.normal;
      to.alpha += from.alpha;
      to.photon_density += from.photon_density;
      to.samples += from.samples;
      for (int g = 0; g < sum.light_groups; ++g) sum.groups_of(i)[g] += pass.by_group[i * sum.light_groups + g];
    }
  });
}

}  // namespace photon_splat
