#version 330 core

// A surface made of a low-rank AMC: at every k a mixture of the same few pictures, never multiplied out.

#include "amc_read.glsl"

uniform sampler2DArray pictures; // columns, rows (row 0 at n_y = +1), rank; signed
uniform sampler2DArray curves;   // slices; four pictures' weights a layer
uniform Meaning meaning;
uniform int rank;
uniform vec3 table_size; // columns, rows, slices

out vec4 colour;

// The level that a volume of this size would be read from.
float fitting_level(Reading at) {
    vec3 x = at.along_x * table_size, y = at.along_y * table_size;
    return 0.5 * log2(max(max(dot(x, x), dot(y, y)), 1e-12));
}

void main() {
    Reading at = reading_of(meaning);
    float from_level = level < 0.0 ? fitting_level(at) : level;
    vec3 light = vec3(0.0);
    for (int four = 0; 4 * four < rank; ++four) {
        vec4 weights = textureLod(curves, vec3(at.coordinates.z, 0.5, float(four)), from_level);
        for (int one = 0; one < min(4, rank - 4 * four); ++one)
            light += weights[one] * textureLod(pictures, vec3(at.coordinates.xy, float(4 * four + one)), from_level).rgb;
    }
    // Sums of few pictures undershoot beside a sharp highlight; light does not.
    colour = vec4(darkened(max(light, vec3(0.0))), 1.0);
}
