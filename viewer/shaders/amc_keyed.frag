#version 330 core

// A surface made of two AMCs of one form: one lit by everything, the other by everything but the key light, which is
// what shows where the key light is in shadow (the AMC paper, section 6.1).

#include "amc_read.glsl"
#include "key_shadow.glsl"

uniform sampler3D table;
uniform sampler3D unlit_table;
uniform Meaning meaning;

out vec4 colour;

void main() {
    Reading at = reading_of(meaning);
    float reached = key_reaches(visible_normal(direction_to_eye()));
    vec3 light = mix(read_table(unlit_table, at), read_table(table, at), reached);
    colour = vec4(darkened(light), 1.0);
}
