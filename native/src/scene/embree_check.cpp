#include "scene/embree_check.h"

#include <embree4/rtcore.h>

#include <stdexcept>
#include <string>

namespace photon_splat {
namespace {

constexpr long first_version = 40000;
constexpr long end_version = 50000;

std::string dotted(long version) {
  return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
         std::to_string(version % 100);
}

}  // namespace

void check_embree_version() {
  // No thread count is given: Embree would limit TBB, and with it Blender, to that many in the
  // whole process.
  RTCDevice device = rtcNewDevice(nullptr);
  if (!device) {
    const int error = rtcGetDeviceError(nullptr);
    throw std::runtime_error(
        "Embree, which Photon Splat traces rays with, could not be started (its error " +
        std::to_string(error) + ").");
  }
  const long version = static_cast<long>(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION));
  rtcReleaseDevice(device);
  if (version < first_version || version >= end_version) {
    throw std::runtime_error("Photon Splat needs Embree 4, but Embree " + dotted(version) +
                             " is loaded in this process.");
  }
}

}  // namespace photon_splat
