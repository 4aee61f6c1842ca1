#version 330 core

// A surface made of a decomposed MatCap: low and high frequencies, each over all directions (the MatCap paper, section 5).

#include "common.glsl"
#include "table_normals.glsl"
#include "paraboloid.glsl"

uniform sampler2D low_front;
uniform sampler2D low_back;
uniform sampler2D high_front;
uniform sampler2D high_back;
uniform vec3 low_colour; // base colours
uniform vec3 high_colour;
uniform vec2 slopes; // low, high
uniform int table_normal;
uniform float level; // mip level to read; below 0: the one that fits

out vec4 colour;

const float EDGE_ON = 0.2;

// The direction that a normal at an angle θ off the view axis shows: on the same side, at θ·(1 + slope).
vec3 turned_away(vec3 n, float slope) {
    float across = length(n.xy);
    if (across == 0.0) return n;
    float angle = atan(across, n.z) * (1.0 + slope);
    return vec3(n.xy / across * sin(angle), cos(angle));
}

void main() {
    vec3 to_eye = direction_to_eye();
    vec3 n = visible_normal(to_eye);
    vec3 turned = table_normal_of(n, to_eye, table_normal);
    if (turned.z < 0.0) turned = vec3(normalize(turned.xy), 0.0);
    float trust = min(1.0, dot(n, to_eye) / EDGE_ON);
    vec3 low = read_paraboloid(low_front, low_back, turned_away(turned, slopes.x), level, trust);
    vec3 high = read_paraboloid(high_front, high_back, turned_away(turned, slopes.y), level, trust);
    colour = vec4(darkened(low * low_colour + high * high_colour), 1.0);
}
