#version 330
// What the photons of one run add to one point: the sums of native/src/simd/splat_kernel.inl.

const uint PHOTONS_PER_ROW = 1024u;
const uint PAIRS_PER_ROW = 4096u;

const float NORMAL_WEIGHT_SLOPE = 2.0;   // kNormalWeightSlope of native/src/point_block.h

const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);     // kLuminance, likewise

uniform sampler2D positions;   // x, y, z, 1/h^2 of the texel's point
uniform usampler2D planes;     // bits of its normal; surface patch and side
uniform usampler2D photons;    // two texels a photon: x, y, z, key | normal and direction, red, green, blue
uniform usampler2D order;      // photon of each pair

flat in uvec2 pairs;

layout(location = 0) out vec4 sums;     // power times kernel, photons caught; added up by blending
layout(location = 1) out float narrow;  // luminance times the kernel of radius h/sqrt(2); likewise

// decode_direction() of native/src/vec.h
vec3 direction(uint code) {
    vec2 p = vec2(code & 255u, code >> 8 & 255u) / 127.0 - 1.0;
    float z = 1.0 - abs(p.x) - abs(p.y);
    if (z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    return normalize(vec3(p, z));
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 point = texelFetch(positions, at, 0);
    uvec4 plane = texelFetch(planes, at, 0);
    sums = vec4(0.0);
    narrow = 0.0;
    for (uint i = pairs.x; i < pairs.y; ++i) {
        uint photon = texelFetch(order, ivec2(i % PAIRS_PER_ROW, i / PAIRS_PER_ROW), 0).x;
        ivec2 place = ivec2(2u * (photon % PHOTONS_PER_ROW), photon / PHOTONS_PER_ROW);
        uvec4 hit = texelFetch(photons, place, 0);
        vec3 offset = uintBitsToFloat(hit.xyz) - point.xyz;
        float relative = dot(offset, offset) * point.w;
        float kernel = 1.0 - relative;
        if (kernel > 0.0 && hit.w == plane.w) {
            uvec4 light = texelFetch(photons, place + ivec2(1, 0), 0);
            float facing = NORMAL_WEIGHT_SLOPE * dot(uintBitsToFloat(plane.xyz), direction(light.x));
            vec3 power = min(facing, 1.0) * uintBitsToFloat(light.yzw);
            if (facing > 0.0) {
                sums += vec4(kernel * power, 1.0);
                narrow += max(kernel - relative, 0.0) * dot(power, LUMINANCE);
            }
        }
    }
}
