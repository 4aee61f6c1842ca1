// What a PTM, or its kin in another basis, gives under lights. All is in the frame of its picture: x right, y up, z out.

#include "light_basis.glsl"
#include "srgb.glsl"

const int MOST_LIGHTS = 64;

uniform sampler2DArray coefficients; // a layer each term
uniform int light_count;
uniform vec3 light_directions[MOST_LIGHTS]; // unit, from the surface to the light
uniform vec3 light_colours[MOST_LIGHTS];    // linear light
uniform bool is_display;                    // values are sRGB, not light
#ifdef LUMINANCE
uniform sampler2D luminance_colour; // the factor of the luminance in an LRGB material
#endif
#ifdef GAIN
uniform sampler2D brightest; // u and v of the light under which a texel is brightest
uniform float diffuse_gain;
#endif
#ifdef GLOSS
uniform sampler2D normals;
uniform vec2 gloss; // strength, exponent
#endif

struct Texel {
    vec3 c[TERMS];
    vec3 factor;
    vec2 brightest;
    vec3 normal;
};

// Diffuse gain (Malzbender and others, 2001): second derivatives grow by the gain about the brightest light.
#ifdef GAIN
Texel gained(Texel texel) {
    vec2 l = texel.brightest;
    float rest = 1.0 - diffuse_gain;
    vec3 a0 = texel.c[0], a1 = texel.c[1], a2 = texel.c[2];
    texel.c[3] += rest * (2.0 * a0 * l.x + a2 * l.y);
    texel.c[4] += rest * (2.0 * a1 * l.y + a2 * l.x);
    texel.c[5] -= rest * (a0 * (l.x * l.x) + a1 * (l.y * l.y) + a2 * (l.x * l.y));
    for (int term = 0; term < 3; ++term) texel.c[term] *= diffuse_gain;
    return texel;
}
#endif

// The value in the material's own space, with a Blinn–Phong lobe on top where a highlight was asked for.
vec3 value_under(Texel texel, vec3 light, vec3 to_eye) {
    float values[TERMS];
    basis_of(light, values);
    vec3 value = vec3(0.0);
    for (int term = 0; term < TERMS; ++term) value += values[term] * texel.c[term];
#ifdef LUMINANCE
    value = value.r * texel.factor;
#endif
#ifdef GLOSS
    vec3 half_way = normalize(light + to_eye);
    float cosine = max(dot(texel.normal, half_way), 0.0);
    value += gloss.x * (cosine > 0.0 ? pow(cosine, gloss.y) : 0.0);
#endif
    return value;
}

vec3 light_of(vec3 value) {
    return is_display ? decode_srgb(value) : value;
}
