#version 330
// What the photons of one run add to one point: the sums of native/src/simd/splat_kernel.inl.

const uint PHOTONS_PER_ROW = 1024u;
const uint PAIRS_PER_ROW = 4096u;

const float NORMAL_WEIGHT_SLOPE = 2.0;   // kNormalWeightSlope of native/src/point_block.h

uniform sampler2D positions;   // x, y, z, 1/h^2 of the texel's point
uniform usampler2D planes;     // bits of its normal; surface patch and side
uniform usampler2D photons;    // two texels a photon: x, y, z, key | normal and direction, red, green, blue
uniform usampler2D order;      // photon of each pair

flat in uvec2 pairs;

out vec4 sums;                 // power times kernel, photons caught; added up by blending

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
    for (uint i = pairs.x; i < pairs.y; ++i) {
        uint photon = texelFetch(order, ivec2(i % PAIRS_PER_ROW, i / PAIRS_PER_ROW), 0).x;
        ivec2 place = ivec2(2u * (photon % PHOTONS_PER_ROW), photon / PHOTONS_PER_ROW);
        uvec4 hit = texelFetch(photons, place, 0);
        vec3 offset = uintBitsToFloat(hit.xyz) - point.xyz;
        float kernel = 1.0 - dot(offset, offset) * point.w;
        if (kernel > 0.0 && hit.w == plane.w) {
            uvec4 light = texelFetch(photons, place + ivec2(1, 0), 0);
            float facing = NORMAL_WEIGHT_SLOPE * dot(uintBitsToFloat(plane.xyz), direction(light.x));
            if (facing > 0.0) sums += vec4(kernel * min(facing, 1.0) * uintBitsToFloat(light.yzw), 1.0);
        }
    }
}
