#version 330 core

// Tangents as thin strips in the surface, their corners counted from the middle of each.

#include "surface.glsl"

uniform mat3 view_from_object;
uniform mat4 clip_from_view;
uniform vec2 strip; // length and width

in vec3 in_position;
in vec3 in_normal;
in vec3 in_tangent;
in vec2 in_corner; // ±½ along and across

const float LIFT = 0.012;

void main() {
    vec3 along = in_tangent * (in_corner.x * strip.x), across = cross(in_normal, in_tangent) * (in_corner.y * strip.y);
    vec3 position = view_from_object * (in_position + along + across);
    // Lifted towards the eye, a strip stays where it is seen, and clears the bulge of the surface under it.
    gl_Position = clip_from_view * vec4(position + LIFT * eye_seen_from(position), 1.0);
}
