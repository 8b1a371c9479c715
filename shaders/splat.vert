// One instance a run of photons, drawn as the quad of the 8x8 texels that hold the points of its block.

const float TILE = 8.0;

uniform int columns;       // tiles per row of the atlas
uniform vec2 texel_size;   // of the atlas, in clip space

in uvec3 run;              // block counted from the atlas's first, first pair, pairs

flat out uvec2 pairs;      // first, end

void main() {
    vec2 tile = vec2(int(run.x) % columns, int(run.x) / columns);
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4((tile + corner) * TILE * texel_size - 1.0, 0.0, 1.0);
    pairs = uvec2(run.y, run.y + run.z);
}
