#version 330 core

// A surface made of an AMC whose k, and with PLACE_PER_VERTEX also i and j, were found at the vertices and lie straight
// between them (the AMC paper, sections 6 and 6.2).

#include "amc_read.glsl"

uniform sampler3D table; // columns, rows (row 0 at n_y = +1), slices
uniform Meaning meaning;

in vec4 front_place; // column, row, k, k'
in vec4 back_place;

out vec4 colour;

void main() {
    vec4 place = gl_FrontFacing ? front_place : back_place;
    vec4 along_x = dFdx(place), along_y = dFdy(place);
#ifndef PLACE_PER_VERTEX
    vec3 to_eye = direction_to_eye();
    place.xy = disc_place(table_normal_of(visible_normal(to_eye), to_eye, meaning.table_normal));
    along_x.xy = dFdx(place.xy);
    along_y.xy = dFdy(place.xy);
#endif
    // Between two vertices on either side of the jump, k goes the long way round, and changes more than k' does.
    bool twin = seam_trick && abs(along_x.w) + abs(along_y.w) < abs(along_x.z) + abs(along_y.z);
    Reading at = twin ? trusted(place.xyw, along_x.xyw, along_y.xyw, meaning)
                      : trusted(place.xyz, along_x.xyz, along_y.xyz, meaning);
    colour = vec4(darkened(read_table(table, at)), 1.0);
}
