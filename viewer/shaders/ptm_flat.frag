#version 330 core

// A PTM as the picture that it is, from its texels. Row 0 of the textures is drawn at the bottom, and is read back first.

#include "ptm.glsl"

uniform vec2 texels_a_pixel;
uniform int first_row;       // of the picture's rows, in this drawing
uniform int first_texel_row; // of the window's rows, in these textures
uniform vec3 only_light;     // for values as they are stored, which do not add up

out vec4 value;

#ifdef NORMALS
uniform sampler2D normals;
#define LAID_OUT normals

vec3 shown(ivec2 at) {
    return 0.5 + 0.5 * texelFetch(normals, at, 0).xyz;
}
#else
#define LAID_OUT coefficients

vec3 shown(ivec2 at) {
    Texel texel;
    for (int term = 0; term < TERMS; ++term) texel.c[term] = texelFetch(coefficients, ivec3(at, term), 0).rgb;
#ifdef LUMINANCE
    texel.factor = texelFetch(luminance_colour, at, 0).rgb;
#endif
#ifdef GLOSS
    texel.normal = texelFetch(normals, at, 0).xyz;
#endif
#ifdef GAIN
    texel.brightest = texelFetch(brightest, at, 0).xy;
    texel = gained(texel);
#endif
    const vec3 to_eye = vec3(0.0, 0.0, 1.0);
#ifdef AS_LIGHT
    vec3 sum = vec3(0.0);
    for (int number = 0; number < light_count; ++number)
        sum += light_colours[number] * light_of(value_under(texel, light_directions[number], to_eye));
    return sum;
#else
    return value_under(texel, only_light, to_eye);
#endif
}
#endif

#ifdef AVERAGED
// Light is what adds up; stored display values are averaged as light.
vec3 shown_as_light(ivec2 at) {
#if defined(AS_LIGHT) || defined(NORMALS)
    return shown(at);
#else
    return light_of(shown(at));
#endif
}

vec3 average(vec2 from) {
    vec2 to = from + texels_a_pixel;
    ivec2 most = textureSize(LAID_OUT, 0).xy - 1;
    vec3 sum = vec3(0.0);
    float whole = 0.0;
    for (int y = int(floor(from.y)); y < int(ceil(to.y)); ++y)
        for (int x = int(floor(from.x)); x < int(ceil(to.x)); ++x) {
            vec2 overlap = min(to, vec2(x, y) + 1.0) - max(from, vec2(x, y));
            float share = overlap.x * overlap.y;
            sum += share * shown_as_light(clamp(ivec2(x, y - first_texel_row), ivec2(0), most));
            whole += share;
        }
#if defined(AS_LIGHT) || defined(NORMALS)
    return sum / whole;
#else
    return is_display ? encode_srgb(sum / whole) : sum / whole;
#endif
}
#endif

void main() {
    vec2 from = (gl_FragCoord.xy - 0.5 + vec2(0.0, float(first_row))) * texels_a_pixel;
#ifdef AVERAGED
    value = vec4(average(from), 1.0);
#else
    value = vec4(shown(ivec2(floor(from + 0.5 * texels_a_pixel)) - ivec2(0, first_texel_row)), 1.0);
#endif
}
