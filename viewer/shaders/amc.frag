#version 330 core

// Reads an Anisotropic MatCap (the AMC paper, section 6).

#include "common.glsl"
#include "table_normals.glsl"

uniform sampler3D table;   // columns, rows (row 0 at n_y = +1), slices
uniform int table_normal;
uniform bool angle_in_surface; // k counts the tangent's angle there, not that of its picture
uniform float repeats;     // R
uniform float first_slice; // texture coordinate of slice 0: the centre of its texel
uniform float level;       // mip level to read; below 0: the one that fits
uniform bool seam_trick;

out vec4 colour;

const float TURN = 6.283185307179586;
const float EDGE_ON = 0.2;

float tangent_k(vec2 t) {
    return dot(t, t) > 0.0 ? fract(atan(t.y, t.x) / TURN) : 0.0;
}

// k jumps from 1 to 0 somewhere, its twin k' half a turn away; both are the same place in the table. Where one jumps,
// the card would take the jump for minification, so the change from pixel to pixel is that of the one which changes
// less (section 6.2, per fragment). Handing over the change itself, not k or k' for the card to difference, matters:
// the four pixels of a quad need not choose alike.
float change(float of_k, float of_k_prime) {
    return seam_trick && abs(of_k_prime) < abs(of_k) ? of_k_prime : of_k;
}

void main() {
    vec3 to_eye = direction_to_eye();
    vec3 n = visible_normal(to_eye);
    vec3 turned = table_normal_of(n, to_eye, table_normal);
    vec3 t = rotate_smallest(tangent_in_plane(n), n, turned);
    vec2 disc = turned.z < 0.0 ? normalize(turned.xy) : turned.xy;
    vec2 place = vec2(0.5 + 0.5 * disc.x, 0.5 - 0.5 * disc.y);
    float k = tangent_k(angle_in_surface ? rotate_smallest(t, turned, Z).xy : t.xy);
    float k_prime = fract(k + 0.5) - 0.5;
    // On a triangle seen nearly edge-on a pixel's neighbours are extrapolated far past its corners, the farther the
    // more it is turned away, and the silhouette would be read from levels that are much too small.
    float trust = min(1.0, dot(n, to_eye) / EDGE_ON);
    vec3 coordinates = vec3(place, k * repeats + first_slice);
    vec3 along_x = vec3(dFdx(place), change(dFdx(k), dFdx(k_prime)) * repeats);
    vec3 along_y = vec3(dFdy(place), change(dFdy(k), dFdy(k_prime)) * repeats);
    vec4 texel = level < 0.0 ? textureGrad(table, coordinates, along_x * trust, along_y * trust)
                             : textureLod(table, coordinates, level);
    colour = vec4(texel.rgb, 1.0);
}
