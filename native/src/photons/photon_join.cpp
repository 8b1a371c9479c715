#include "photons/photon_join.h"

#include <algorithm>
#include <cmath>

namespace photon_splat {

float power_dispersion(const Photons& photons) {
  constexpr double kMost = 32;
  double sum = 0, squares = 0;
  for (const Photon& p : photons) {
    const double power = luminance(p.power);
    sum += power;
    squares += power * power;
  }
  const double found = static_cast<double>(photons.size()) * squares / (sum * sum);
  return std::isfinite(found) ? static_cast<float>(std::clamp(found, 1.0, kMost)) : 1;
}

void PhotonJoin::clear() {
  photons_.clear();
  groups_.clear();
  beams_.clear();
  stops_.clear();
  runs_.clear();
  brought_ = 0;
  rays_ = shaded_ = next_ = 0;
}

void PhotonJoin::begin(size_t runs, size_t expected, bool with_groups) {
  clear();
  with_groups_ = with_groups;
  runs_.resize(runs);
  photons_.reserve(expected);
  if (with_groups) groups_.reserve(photons_.capacity());
}

std::unique_ptr<PhotonRun> PhotonJoin::take() {
  const std::lock_guard lock(*mutex_);
  if (spare_.empty()) return std::make_unique<PhotonRun>();
  std::unique_ptr<PhotonRun> run = std::move(spare_.back());
  spare_.pop_back();
  run->clear();
  return run;
}

void PhotonJoin::count(const PhotonRun& run) {
  photons_.resize(photons_.size() + run.photons.size());
  if (with_groups_) groups_.resize(photons_.size());
  beams_.insert(beams_.end(), run.beams.begin(), run.beams.end());
  stops_.insert(stops_.end(), run.stops.begin(), run.stops.end());
  brought_ += run.brought;
  rays_ += run.rays;
  shaded_ += run.shaded;
}

void PhotonJoin::put(const PhotonRun& run, Photon* photons, int16_t* groups) const {
  std::copy(run.photons.begin(), run.photons.end(), photons);
  if (with_groups_) std::copy(run.groups.begin(), run.groups.end(), groups);
}

void PhotonJoin::add(size_t number, std::unique_ptr<PhotonRun> run) {
  std::unique_lock lock(*mutex_);
  runs_[number] = std::move(run);
  while (next_ < runs_.size() && runs_[next_]) {
    const size_t place = photons_.size();
    if (place + runs_[next_]->photons.size() > photons_.capacity()) return;
    std::unique_ptr<PhotonRun> now = std::move(runs_[next_++]);
    count(*now);
    Photon* const photons = photons_.data() + place;  // stay where they are
    int16_t* const groups = groups_.data() + (with_groups_ ? place : 0);
    lock.unlock();
    put(*now, photons, groups);
    lock.lock();
    spare_.push_back(std::move(now));
  }
}

void PhotonJoin::finish(ThreadPool& pool, const CancelFlag& cancel) {
  const size_t first = next_;
  std::vector<size_t> places;
  size_t all = photons_.size();
  for (size_t i = first; i < runs_.size(); ++i) all += runs_[i]->photons.size();
  photons_.reserve(all);
  for (size_t i = first; i < runs_.size(); ++i) {
    places.push_back(photons_.size());
    count(*runs_[i]);
  }
  pool.for_each(places.size(), cancel, [&](size_t i, int) {
    put(*runs_[first + i], photons_.data() + places[i],
        groups_.data() + (with_groups_ ? places[i] : 0));
  });
  runs_.clear();
  if (spare_.size() > static_cast<size_t>(pool.size())) spare_.resize(pool.size());
}

}  // namespace photon_splat
