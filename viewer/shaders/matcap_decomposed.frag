#version 330 core

// A surface made of a decomposed MatCap: low and high frequencies, each over all directions (the MatCap paper, section 5).
// Switches name what varies over the surface, by its texture coordinates (figures 14 to 16).

#include "common.glsl"
#include "table_normals.glsl"
#include "paraboloid.glsl"
#include "litrig_matcap.glsl"

uniform sampler2D low_front;
uniform sampler2D low_back;
uniform sampler2D high_front;
uniform sampler2D high_back;
uniform sampler2D low_remainder;
uniform sampler2D high_remainder;
uniform MatcapHalf low;
uniform MatcapHalf high;
uniform int table_normal;
uniform float level;    // mip level to read; below 0: the one that fits
uniform vec2 occlusion; // how much of the occlusion darkens low and high, 0 to 1

in vec2 uv;

#ifdef LOW_COLOUR
uniform sampler2D low_colours;
#endif
#ifdef HIGH_COLOUR
uniform sampler2D high_colours;
#endif
#ifdef OPENNESS
uniform sampler2D open_map;
#endif
#ifdef MATERIALS
uniform sampler2D materials; // whose number a place has
uniform float material;      // this one's
#endif
#ifdef ROUGHNESS
uniform sampler2D roughness; // 0 to 1
uniform vec2 filter_sizes;   // ν of low and high
uniform vec2 rougher;        // what is added to them where the roughness is 1
uniform sampler3D low_front_blurs; // the maps blurred on the sphere: by a variance of `first`, twice that, and so on
uniform sampler3D low_back_blurs;
uniform sampler3D high_front_blurs;
uniform sampler3D high_back_blurs;
uniform float first;
#endif

out vec4 colour;

const float EDGE_ON = 0.2;

vec3 varied(sampler2D plane, vec2 place) {
    return (level < 0.0 ? texture(plane, place) : textureLod(plane, place, level)).rgb;
}

// What the maps lack in a direction.
vec3 remaining(MatcapHalf half_of, sampler2D remainder, vec3 direction, float trust) {
    if (half_of.remainder_share == 0.0) return vec3(0.0);
    vec3 source = matcap_source(half_of, direction);
    vec2 place = vec2(0.5 + 0.5 * source.x, 0.5 - 0.5 * source.y);
    vec2 x = dFdx(place) * trust, y = dFdy(place) * trust;
    vec3 lacking = level < 0.0 ? textureGrad(remainder, place, x, y).rgb : textureLod(remainder, place, level).rgb;
    return matcap_share(half_of, source) * lacking;
}

#ifdef ROUGHNESS
float slope_of(float filter_size) {
    return clamp(1.0 - 0.3 * filter_size - 1.1 * filter_size * filter_size, 0.0, 1.0);
}

// Read maps that are blurred by a variance more than `sharp`, which was read already.
vec3 blurred_by(vec3 sharp, sampler3D front, sampler3D back, vec3 direction, float variance) {
    float steps = variance / first;
    float level = steps < 1.0 ? steps : 1.0 + log2(steps);
    float depth = (max(level, 1.0) - 0.5) / float(textureSize(front, 0).z);
    vec3 in_front = textureLod(front, vec3(paraboloid_place(direction, 1.0), depth), 0.0).rgb;
    vec3 behind = textureLod(back, vec3(paraboloid_place(direction, -1.0), depth), 0.0).rgb;
    return mix(sharp, direction.z >= 0.0 ? in_front : behind, min(level, 1.0));
}
#endif

void main() {
    vec2 place = vec2(uv.x, 1.0 - uv.y);
#ifdef MATERIALS
    if (abs(textureLod(materials, place, 0.0).r - material) > 0.5) discard;
#endif
    vec3 to_eye = direction_to_eye();
    vec3 n = visible_normal(to_eye);
    vec3 turned = table_normal_of(n, to_eye, table_normal);
    if (turned.z < 0.0) turned = vec3(normalize(turned.xy), 0.0);
    float trust = min(1.0, dot(n, to_eye) / EDGE_ON);
    MatcapHalf here[2] = MatcapHalf[2](low, high);
#ifdef ROUGHNESS
    vec2 more = varied(roughness, place).r * rougher;
    for (int which = 0; which < 2; ++which)
        here[which].slope = clamp(here[which].slope + slope_of(filter_sizes[which] + more[which])
            - slope_of(filter_sizes[which]), 0.0, 1.0);
#endif
    vec3 low_seen = matcap_seen(here[0], turned), high_seen = matcap_seen(here[1], turned);
    vec3 low_light = read_paraboloid(low_front, low_back, low_seen, level, trust);
    vec3 high_light = read_paraboloid(high_front, high_back, high_seen, level, trust);
#ifdef ROUGHNESS
    low_light = blurred_by(low_light, low_front_blurs, low_back_blurs, low_seen, more.x);
    high_light = blurred_by(high_light, high_front_blurs, high_back_blurs, high_seen, more.y);
#endif
    low_light = max(low_light + remaining(here[0], low_remainder, low_seen, trust), vec3(0.0));
    high_light = max(high_light + remaining(here[1], high_remainder, high_seen, trust), vec3(0.0));
    low_light *= matcap_energy(here[0], turned);
    high_light *= matcap_energy(here[1], turned);
#ifdef LOW_COLOUR
    low_light *= varied(low_colours, place);
#endif
#ifdef HIGH_COLOUR
    high_light *= varied(high_colours, place);
#endif
    float open = occluded ? openness : 1.0;
#ifdef OPENNESS
    open *= varied(open_map, place).r;
#endif
    vec2 left = mix(vec2(1.0), vec2(open), occlusion);
    colour = vec4(low_light * left.x + high_light * left.y, 1.0);
}
