// What every mesh shader needs: where the eye is, and a surface's frame at a fragment. All is in the view frame.

uniform float eye_distance; // the eye is at (0, 0, eye_distance); 0 if the projection is orthographic

in vec3 view_position;
in vec3 view_normal;
in vec3 view_tangent;

const float GRAZING = 1e-3;

vec3 direction_to_eye() {
    return eye_distance > 0.0 ? normalize(vec3(0.0, 0.0, eye_distance) - view_position) : vec3(0.0, 0.0, 1.0);
}

// The normal on the visible side. A triangle and its normal must agree that it is the back which is seen: at a
// silhouette one of them alone is often wrong. What then still looks away from the eye is bent back to the silhouette.
vec3 visible_normal(vec3 to_eye) {
    vec3 n = normalize(view_normal);
    float towards = dot(n, to_eye);
    if (!gl_FrontFacing && towards < 0.0) {
        n = -n;
        towards = -towards;
    }
    return towards < GRAZING ? normalize(n + to_eye * (GRAZING - towards)) : n;
}

vec3 tangent_in_plane(vec3 n) {
    return normalize(view_tangent - n * dot(view_tangent, n));
}
