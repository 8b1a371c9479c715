// One work group a list of photons, a thread a point of its block; photons are staged in shared memory. Runs of LONGEST_RUN
// are summed first and then added one by one, as blending adds them: both ways to splat give the same bits.
#include "estimate.glsl"

const uint STAGED = 64u;        // a photon a thread
const uint LONGEST_RUN = 128u;  // as in painter.py; a multiple of STAGED
const int TILE = 8;

layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Lists { uint lists[]; };   // block counted from the atlas's first, first pair, pairs
layout(rgba32f) uniform image2D sums_image;   // as add_photon() has them
layout(r32f) uniform image2D narrow_image;

uniform int columns;       // tiles per row of the atlas
uniform uint list_count;

shared uvec4 hits[STAGED];    // x, y, z, key
shared vec4 normals[STAGED];  // with red
shared vec2 powers[STAGED];   // green, blue

void stage(uint pair, uint slot) {
    ivec2 place = place_of(pair);
    uvec4 light = texelFetch(photons, place + ivec2(1, 0), 0);
    vec3 power = uintBitsToFloat(light.yzw);
    hits[slot] = texelFetch(photons, place, 0);
    normals[slot] = vec4(direction(light.x), power.r);
    powers[slot] = power.gb;
}

void main() {
    uint list = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (list >= list_count) return;  // the whole group
    uint thread = gl_LocalInvocationIndex;
    int block = int(lists[3u * list]);
    uint first = lists[3u * list + 1u], count = lists[3u * list + 2u];
    ivec2 at = TILE * ivec2(block % columns, block / columns) + ivec2(int(thread) % TILE, int(thread) / TILE);
    vec4 point = texelFetch(positions, at, 0);
    uvec4 plane = texelFetch(planes, at, 0);
    vec3 normal = uintBitsToFloat(plane.xyz);
    EXACT vec4 sums = imageLoad(sums_image, at);
    EXACT float narrow = imageLoad(narrow_image, at).x;
    for (uint run = 0u; run < count; run += LONGEST_RUN) {
        EXACT vec4 run_sums = vec4(0.0);
        EXACT float run_narrow = 0.0;
        uint run_end = min(run + LONGEST_RUN, count);
        for (uint begin = run; begin < run_end; begin += STAGED) {
            uint staged = min(run_end - begin, STAGED);
            if (thread < staged) stage(first + begin + thread, thread);
            barrier();
            for (uint i = 0u; i < staged; ++i) {
                float relative = relative_distance(point, hits[i].xyz);
                if (relative < 1.0 && hits[i].w == plane.w)
                    add_photon(relative, normal, normals[i].xyz, vec3(normals[i].w, powers[i]), run_sums, run_narrow);
            }
            barrier();
        }
        sums += run_sums;
        narrow += run_narrow;
    }
    imageStore(sums_image, at, sums);
    imageStore(narrow_image, at, vec4(narrow));
}
