// Colours of single wavelengths.
#pragma once

#include "math/vec.h"

namespace photon_splat {

// Light of one wavelength in linear RGB (Rec. 709), channels below 0 where that has none such: by
// the colour matching functions of the CIE of 1931. 0 beyond 380 to 780 nm.
Rgb spectral_rgb(float nanometres);

}  // namespace photon_splat
