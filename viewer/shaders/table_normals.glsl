// Which normal indexes a table that was photographed in perspective; the same choices as where tables are built.

const int RECTIFIED = 0; // half way between the mirrored ray and z: best for gloss
const int VIEW = 1;      // the smallest rotation of the ray to z, whole
const int CAMERA = 2;    // the normal itself: exact for Lambert

const vec3 Z = vec3(0.0, 0.0, 1.0);

// Apply to v the smallest rotation that takes unit `source` to unit `target`.
vec3 rotate_smallest(vec3 v, vec3 source, vec3 target) {
    vec3 both = source + target;
    return v - both * (dot(v, both) / max(1.0 + dot(source, target), 1e-9)) + 2.0 * target * dot(v, source);
}

vec3 table_normal_of(vec3 n, vec3 to_eye, int kind) {
    if (kind == CAMERA) return n;
    if (kind == VIEW) return rotate_smallest(n, to_eye, Z);
    vec3 half_way = 2.0 * dot(n, to_eye) * n - to_eye + Z;
    float size = length(half_way);
    return size > 1e-6 ? half_way / size : n;
}
