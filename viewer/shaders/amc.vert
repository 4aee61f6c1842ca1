#version 330 core

// A mesh with its places in an AMC found at the vertices. Whether a triangle shows its front or its back is not known
// yet, so both are handed on.

#include "mesh.glsl"
#include "surface.glsl"
#include "amc_place.glsl"

uniform Meaning meaning;

out vec4 front_place; // column, row, k, k'
out vec4 back_place;

vec4 place_of(vec3 to_eye, bool front) {
    vec3 n = visible_side(normalize(view_normal), to_eye, front);
    vec3 place = table_place(n, in_plane(view_tangent, n), to_eye, meaning);
    return vec4(place, twin_of(place.z));
}

void main() {
    place_vertex();
    vec3 to_eye = eye_seen_from(view_position);
    front_place = place_of(to_eye, true);
    back_place = place_of(to_eye, false);
}
