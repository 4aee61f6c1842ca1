#version 330 core

// A PTM laid on a mesh: the light is brought into the frame of the surface at each fragment.

#include "common.glsl"
#include "polynomial.glsl"

uniform vec3 light_direction; // unit, view frame, from the surface to the light
uniform bool is_display;      // the polynomial gives sRGB values, not light
uniform float repeat;         // how often the picture repeats, each way
#ifdef HIGHLIGHT
uniform vec2 highlight;       // strength and exponent
uniform sampler2D texel_normals;
#endif

in vec2 uv;

out vec4 colour;

vec3 decode_srgb(vec3 v) {
    return mix(pow((v + 0.055) / 1.055, vec3(2.4)), v / 12.92, lessThanEqual(v, vec3(0.04045)));
}

void main() {
    vec3 to_eye = direction_to_eye();
    vec3 n = visible_normal(to_eye);
    vec3 t = tangent_in_plane(n);
    // Seen from behind, the picture is mirrored, and so is its frame.
    vec3 b = dot(n, view_normal) > 0.0 ? cross(n, t) : cross(t, n);
    vec2 light = vec2(dot(light_direction, t), dot(light_direction, b));
    vec2 place = repeat * vec2(uv.x, 1.0 - uv.y);
    vec3 c[6];
    for (int term = 0; term < 6; ++term) c[term] = texture(coefficients, vec3(place, float(term))).rgb;
    vec3 p = polynomial(c, light);
    vec3 lit = max(is_luminance ? p.r * texture(luminance_colour, place).rgb : p, vec3(0.0));
#ifdef HIGHLIGHT
    vec3 texel = texture(texel_normals, place).rgb;
    vec3 m = normalize(texel.x * t + texel.y * b + texel.z * n);
    lit += highlight.x * pow(max(dot(m, normalize(light_direction + to_eye)), 0.0), highlight.y);
#endif
    vec3 linear = is_display ? decode_srgb(lit) : lit;
    colour = vec4(darkened(dot(light_direction, n) > 0.0 ? linear : vec3(0.0)), 1.0);
}
