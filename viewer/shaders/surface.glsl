// The side of a surface that is seen, at a vertex or at a fragment. All is in the view frame.

uniform float eye_distance; // the eye is at (0, 0, eye_distance); 0 if the projection is orthographic

const float GRAZING = 1e-3;

vec3 eye_seen_from(vec3 position) {
    return eye_distance > 0.0 ? normalize(vec3(0.0, 0.0, eye_distance) - position) : vec3(0.0, 0.0, 1.0);
}

// The normal on the visible side. A triangle and its normal must agree that it is the back which is seen: at a
// silhouette one of them alone is often wrong. What then still looks away from the eye is bent back to the silhouette.
vec3 visible_side(vec3 n, vec3 to_eye, bool front) {
    float towards = dot(n, to_eye);
    if (!front && towards < 0.0) {
        n = -n;
        towards = -towards;
    }
    return towards < GRAZING ? normalize(n + to_eye * (GRAZING - towards)) : n;
}

vec3 in_plane(vec3 t, vec3 n) {
    return normalize(t - n * dot(t, n));
}
