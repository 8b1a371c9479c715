// Which programs ask where the camera is.
#pragma once

#include "shading/program.h"

namespace photon_splat {

// Whether a checked program may yield something else for another camera, wherever the ray comes
// from.
bool sees_view(const Program& program);

}  // namespace photon_splat
