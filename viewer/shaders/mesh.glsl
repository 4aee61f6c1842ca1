// Where a vertex is seen, and what its fragments need to know of it.

uniform mat3 view_from_object;
uniform mat4 clip_from_view;

in vec3 in_position;
in vec3 in_normal;
in vec3 in_tangent;
in vec2 in_uv;
in float in_occlusion;

out vec3 view_position;
out vec3 view_normal;
out vec3 view_tangent;
out vec2 uv;
out float openness;

void place_vertex() {
    view_position = view_from_object * in_position;
    view_normal = view_from_object * in_normal;
    view_tangent = view_from_object * in_tangent;
    uv = in_uv;
    openness = in_occlusion;
    gl_Position = clip_from_view * vec4(view_position, 1.0);
}
