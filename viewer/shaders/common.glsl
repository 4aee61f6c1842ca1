// What every mesh shader needs: a surface's frame at a fragment. All is in the view frame.

#include "surface.glsl"

uniform bool occluded; // darken by ambient occlusion

in vec3 view_position;
in vec3 view_normal;
in vec3 view_tangent;
in float openness;

vec3 direction_to_eye() {
    return eye_seen_from(view_position);
}

vec3 visible_normal(vec3 to_eye) {
    return visible_side(normalize(view_normal), to_eye, gl_FrontFacing);
}

vec3 tangent_in_plane(vec3 n) {
    return in_plane(view_tangent, n);
}

// Ambient occlusion is a factor on the light (the AMC paper, section 6.1).
vec3 darkened(vec3 light) {
    return occluded ? light * openness : light;
}
