#version 330 core

// A surface made of two AMCs whose light adds up, each with a table normal of its own.

#include "amc_read.glsl"

uniform sampler3D table;
uniform Meaning meaning;
uniform sampler3D other_table;
uniform Meaning other_meaning;

out vec4 colour;

void main() {
    vec3 light = read_table(table, reading_of(meaning)) + read_table(other_table, reading_of(other_meaning));
    colour = vec4(darkened(light), 1.0);
}
