// What the photons of one run add to one point.
#include "estimate.glsl"

flat in uvec2 pairs;

layout(location = 0) out vec4 sums;     // as add_photon() has them; added up by blending
layout(location = 1) out float narrow;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 point = texelFetch(positions, at, 0);
    uvec4 plane = texelFetch(planes, at, 0);
    sums = vec4(0.0);
    narrow = 0.0;
    for (uint i = pairs.x; i < pairs.y; ++i) {
        ivec2 place = place_of(i);
        uvec4 hit = texelFetch(photons, place, 0);
        float relative = relative_distance(point, hit.xyz);
        if (relative < 1.0 && hit.w == plane.w) {
            uvec4 light = texelFetch(photons, place + ivec2(1, 0), 0);
            add_photon(relative, uintBitsToFloat(plane.xyz), direction(light.x), uintBitsToFloat(light.yzw), sums, narrow);
        }
    }
}
