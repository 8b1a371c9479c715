// Included by splat.frag: how photons are stored, and what one adds to the sums of native/src/simd/splat_kernel.inl.

// No operation may be fused with another one: the CPU fuses none.
#if __VERSION__ >= 400
#define EXACT precise
#else
#define EXACT
#endif

const uint PHOTONS_PER_ROW = 1024u;
const uint PAIRS_PER_ROW = 4096u;

const float NORMAL_WEIGHT_SLOPE = 2.0;   // kNormalWeightSlope of native/src/density/point_block.h

const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);     // kLuminance, likewise

uniform sampler2D positions;   // x, y, z, 1/h^2 of the texel's point
uniform usampler2D planes;     // bits of its normal; surface patch and side
uniform usampler2D photons;    // two texels a photon: x, y, z, key | normal and direction, red, green, blue
uniform usampler2D order;      // photon of each pair

// The first texel of a pair's photon.
ivec2 place_of(uint pair) {
    uint photon = texelFetch(order, ivec2(pair % PAIRS_PER_ROW, pair / PAIRS_PER_ROW), 0).x;
    return ivec2(2u * (photon % PHOTONS_PER_ROW), photon / PHOTONS_PER_ROW);
}

// decode_direction() of native/src/math/vec.h
vec3 direction(uint code) {
    EXACT vec2 p = vec2(code & 255u, code >> 8 & 255u) / 127.0 - 1.0;
    EXACT float z = 1.0 - abs(p.x) - abs(p.y);
    if (z < 0.0) p = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    EXACT vec3 n = normalize(vec3(p, z));
    return n;
}

// Squared distance of a photon, bits of its place, over h^2 of a point.
float relative_distance(vec4 point, uvec3 place) {
    EXACT vec3 offset = uintBitsToFloat(place) - point.xyz;
    EXACT float relative = dot(offset, offset) * point.w;
    return relative;
}

// relative: as above, below 1; sums: power times kernel, photons caught; narrow: luminance times the kernel of radius h/sqrt(2).
void add_photon(float relative, vec3 point_normal, vec3 normal, vec3 power, inout vec4 sums, inout float narrow) {
    EXACT float facing = NORMAL_WEIGHT_SLOPE * dot(point_normal, normal);
    if (facing > 0.0) {
        EXACT vec3 light = min(facing, 1.0) * power;
        EXACT float kernel = 1.0 - relative;
        EXACT vec4 wide = sums + vec4(kernel * light, 1.0);
        EXACT float tight = narrow + max(kernel - relative, 0.0) * dot(light, LUMINANCE);
        sums = wide;
        narrow = tight;
    }
}
