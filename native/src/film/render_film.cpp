#include "film/render_film.h"

namespace photon_splat {

void RenderFilm::reset(int width, int height, int light_groups) {
  sum_.reset(width, height, light_groups);
  is_unpacked_ = false;
  errors_.reset(width, height);
}

PackedFilm& RenderFilm::begin_pass(const ChannelMask& channels) {
  pass_.kept = sum_.kept & channels;
  pass_.reset(sum_.width, sum_.height, sum_.light_groups);
  return pass_;
}

void RenderFilm::end_pass(ThreadPool& pool) {
  add_pass(sum_, pass_, pool);
  is_unpacked_ = false;
}

void RenderFilm::restore(PackedFilm sum, const ErrorSums& errors, uint32_t films,
                         ThreadPool& pool) {
  sum_ = std::move(sum);
  is_unpacked_ = false;
  errors_.restore(errors, sum_, films, pool);
}

const Film& RenderFilm::unpacked() const {
  if (!is_unpacked_) sum_.unpack(unpacked_);
  is_unpacked_ = true;
  return unpacked_;
}

}  // namespace photon_splat
