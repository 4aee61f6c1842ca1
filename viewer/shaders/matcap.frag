#version 330 core

// A surface made of a plain MatCap: colour over the normal alone.

#include "common.glsl"
#include "table_normals.glsl"

uniform sampler2D disc; // columns, rows (row 0 at n_y = +1)
uniform int table_normal;
uniform float level;    // mip level to read; below 0: the one that fits

out vec4 colour;

const float EDGE_ON = 0.2;

void main() {
    vec3 to_eye = direction_to_eye();
    vec3 n = visible_normal(to_eye);
    vec3 turned = table_normal_of(n, to_eye, table_normal);
    vec2 within = turned.z < 0.0 ? normalize(turned.xy) : turned.xy;
    vec2 place = vec2(0.5 + 0.5 * within.x, 0.5 - 0.5 * within.y);
    // As for an AMC: edge-on, the change from pixel to pixel is not to be trusted.
    float trust = min(1.0, dot(n, to_eye) / EDGE_ON);
    vec3 light = level < 0.0 ? textureGrad(disc, place, dFdx(place) * trust, dFdy(place) * trust).rgb
                             : textureLod(disc, place, level).rgb;
    colour = vec4(darkened(light), 1.0);
}
