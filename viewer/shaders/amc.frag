#version 330 core

// A surface made of an Anisotropic MatCap (the AMC paper, section 6).

#include "amc_read.glsl"

uniform sampler3D table; // columns, rows (row 0 at n_y = +1), slices
uniform Meaning meaning;

out vec4 colour;

void main() {
    colour = vec4(darkened(read_table(table, reading_of(meaning))), 1.0);
}
