#version 330 core

// A PTM laid on a mesh: lights are brought into the frame of the surface at each fragment.

#include "common.glsl"
#include "ptm.glsl"

uniform float level;  // mip level to read; below 0: the one that fits
uniform float repeat; // how often the picture is laid across the texture coordinates, each way

in vec2 uv;

out vec4 colour;

vec4 read(sampler2D plane, vec2 place) {
    return level < 0.0 ? texture(plane, place) : textureLod(plane, place, level);
}

// The picture's own frame at the fragment, view frame. Seen from behind, the picture is mirrored, and so is its frame.
mat3 picture_frame(vec3 n) {
    vec3 t = tangent_in_plane(n);
    return mat3(t, dot(n, view_normal) > 0.0 ? cross(n, t) : cross(t, n), n);
}

#ifdef NORMALS
uniform sampler2D normals;

vec3 lit(mat3 frame, vec2 place, vec3 to_eye) {
    vec3 n = frame * normalize(read(normals, place).xyz);
    return decode_srgb(0.5 + 0.5 * n); // so that a display shows ½ + ½n
}
#else
vec3 lit(mat3 frame, vec2 place, vec3 to_eye) {
    Texel texel;
    for (int term = 0; term < TERMS; ++term) {
        vec3 at = vec3(place, float(term));
        texel.c[term] = (level < 0.0 ? texture(coefficients, at) : textureLod(coefficients, at, level)).rgb;
    }
#ifdef LUMINANCE
    texel.factor = read(luminance_colour, place).rgb;
#endif
#ifdef GLOSS
    texel.normal = normalize(read(normals, place).xyz);
#endif
#ifdef GAIN
    texel.brightest = read(brightest, place).xy;
    texel = gained(texel);
#endif
    vec3 sum = vec3(0.0);
    for (int number = 0; number < light_count; ++number) {
        vec3 light = light_directions[number] * frame;
        vec3 value = max(value_under(texel, light, to_eye * frame), vec3(0.0));
        sum += light.z > 0.0 ? light_colours[number] * light_of(value) : vec3(0.0);
    }
    return sum;
}
#endif

void main() {
    vec3 to_eye = direction_to_eye();
    vec3 n = visible_normal(to_eye);
    colour = vec4(darkened(lit(picture_frame(n), repeat * vec2(uv.x, 1.0 - uv.y), to_eye)), 1.0);
}
