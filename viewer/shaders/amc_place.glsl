// The place of a normal and a tangent in an AMC (the AMC paper, equations 3 and 4), at a vertex or at a fragment.

#include "table_normals.glsl"

struct Meaning {
    int table_normal;
    bool angle_in_surface; // k counts the tangent's angle there, not that of its picture
    float repeats;         // R
    float first_slice;     // texture coordinate of slice 0: the centre of its texel
};

const float TURN = 6.283185307179586;

float tangent_k(vec2 t) {
    return dot(t, t) > 0.0 ? fract(atan(t.y, t.x) / TURN) : 0.0;
}

// The same place in the table, half a turn away from where k jumps.
float twin_of(float k) {
    return fract(k + 0.5) - 0.5;
}

// Columns and rows, 0 to 1; row 0 is at n_y = +1. What looks away from the camera is read at the rim.
vec2 disc_place(vec3 turned) {
    vec2 disc = turned.z < 0.0 ? normalize(turned.xy) : turned.xy;
    return vec2(0.5 + 0.5 * disc.x, 0.5 - 0.5 * disc.y);
}

// Column, row, and k in [0, 1).
vec3 table_place(vec3 n, vec3 tangent, vec3 to_eye, Meaning meaning) {
    vec3 turned = table_normal_of(n, to_eye, meaning.table_normal);
    vec3 t = rotate_smallest(tangent, n, turned);
    return vec3(disc_place(turned), tangent_k(meaning.angle_in_surface ? rotate_smallest(t, turned, Z).xy : t.xy));
}
