#version 330 core

// A rendered picture under changed normals (the Shape paper, equations 3 to 5, in linear light), pixel by pixel. Row 0 of
// the textures is drawn at the bottom, and is read back first.

#include "paraboloid.glsl"

uniform sampler2D picture;    // I, α
uniform sampler2D diffuse;    // D₀, α_D
uniform sampler2D reflection; // R₀, α_R
uniform sampler2D normals;    // n, and the place of the surface's environment; below 0 there is none
uniform sampler2D to_eye;
uniform sampler2D new_normals;
uniform sampler2D albedo;            // of a single texel where there is none
uniform sampler2D reflection_albedo;
uniform sampler2D factor_maps;       // what k_D and k_R are multiplied by; of a single texel where that is 1
uniform sampler2D harmonics;         // nine coefficients of a surface in a row, and whether D and R are light before albedo
uniform sampler2DArray environment_front; // a layer each surface
uniform sampler2DArray environment_back;
uniform vec2 factors; // k_D, k_R
uniform float horizon; // cosine to the surface as it was, from which down it hides mirrored rays more and more; 0: never

out vec4 value;

const float MISALIGNED = 0.005 * 3.141592653589793; // ε

// Differences of the harmonics from order 1 up, taken before they are weighted: equal normals differ by nothing at all.
vec3 diffuse_change(vec3 from, vec3 to, int surface) {
    vec3 squares = to * to - from * from;
    float terms[9] = float[9](
        0.0,
        0.48860251 * (to.y - from.y),
        0.48860251 * (to.z - from.z),
        0.48860251 * (to.x - from.x),
        1.09254843 * (to.x * to.y - from.x * from.y),
        1.09254843 * (to.y * to.z - from.y * from.z),
        0.94617470 * squares.z,
        1.09254843 * (to.x * to.z - from.x * from.z),
        0.54627422 * (squares.x - squares.y)
    );
    vec3 change = vec3(0.0);
    for (int term = 1; term < 9; ++term) change += terms[term] * texelFetch(harmonics, ivec2(term, surface), 0).rgb;
    return change;
}

vec3 environment(vec3 direction, int surface) {
    if (direction.z >= 0.0)
        return textureLod(environment_front, vec3(paraboloid_place(direction, 1.0), float(surface)), 0.0).rgb;
    return textureLod(environment_back, vec3(paraboloid_place(direction, -1.0), float(surface)), 0.0).rgb;
}

vec4 texel(sampler2D plane, ivec2 at) { return texelFetch(plane, min(at, textureSize(plane, 0) - 1), 0); }

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 whole = texelFetch(picture, at, 0), old = texelFetch(normals, at, 0);
    value = vec4(whole.rgb, 1.0);
    int surface = int(old.w);
    if (surface < 0) return;
    vec3 n = old.xyz, changed = texelFetch(new_normals, at, 0).xyz;
    vec2 k = factors * texel(factor_maps, at).rg;
    // What is untouched keeps its bits, however a driver rounds what follows.
    if (n == changed && k == vec2(1.0)) return;
    vec4 d0 = texelFetch(diffuse, at, 0), r0 = texelFetch(reflection, at, 0);
    vec3 is_illumination = texelFetch(harmonics, ivec2(9, surface), 0).rgb;
    vec3 change = diffuse_change(n, changed, surface) * mix(vec3(1.0), texel(albedo, at).rgb, is_illumination.x);
    // What was negative before may stay so.
    vec3 d = d0.rgb + d0.a * (max(d0.rgb + change, min(d0.rgb, vec3(0.0))) - d0.rgb);
    vec3 eye = texelFetch(to_eye, at, 0).xyz;
    vec3 r = reflect(-eye, n), new_r = reflect(-eye, changed);
    // The chord, and not the cosine, is nothing where nothing was changed.
    float angle = 2.0 * asin(min(1.0, 0.5 * length(r - new_r)));
    float share = min(1.0, angle / MISALIGNED) * r0.a;
    if (horizon > 0.0) share *= clamp(dot(new_r, n) / horizon, 0.0, 1.0);
    vec3 mirrored = environment(new_r, surface) * mix(vec3(1.0), texel(reflection_albedo, at).rgb, is_illumination.y);
    vec3 new_reflection = r0.rgb + share * (mirrored - r0.rgb);
    // Written as a change, which is none in what the picture has besides.
    value.rgb += whole.a * ((k.x * d - d0.rgb) + (k.y * new_reflection - r0.rgb));
}
