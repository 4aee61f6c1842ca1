// A decomposed MatCap (litrig, X.matcap.exr; the paper "MatCap Decomposition for Dynamic Appearance Manipulation",
// sections 3 and 5). This file needs no other: paste it into a fragment shader of GLSL 3.30, or ES 3.00 with highp
// floats. For each half, low and high, give a MatcapHalf and the two square maps of the file, their first row on top,
// linearly filtered and clamped to their edges. The colour of a surface is
//
//     matcap_light(low, low_front, low_back, n) + matcap_light(high, high_front, high_back, n)
//
// in linear light, with n the unit normal as the camera sees it: x right, y up, z towards the camera. Where the file has
// remainders, what the maps lack of the picture that they were made of, they can be given after the maps, filtered alike.

struct MatcapHalf {
    vec3 base_colour;  // α₀
    float slope;       // μ
    vec3 silhouette;   // θ₀ in radians, α₁, m₁; (0, 0, 0) for none
    mat3 normals_back; // undoes the turn of the normals; the unit matrix for none
    mat3 light_back;   // undoes the turn of the light
    float remainder_share; // 1 where the light is not tipped off the view axis, 0 from one degree on, straight between
};

// The direction that a normal at an angle θ off the view axis shows: on the same side, at θ·(1 + μ).
vec3 matcap_warped(vec3 n, float slope) {
    float across = length(n.xy);
    if (across == 0.0) return n;
    float angle = atan(across, n.z) * (1.0 + slope);
    return vec3(n.xy / across * sin(angle), cos(angle));
}

// Where in the maps a normal looks.
vec3 matcap_seen(MatcapHalf half_of, vec3 n) {
    return half_of.light_back * matcap_warped(half_of.normals_back * n, half_of.slope);
}

// α(θ) = α₀ + s(θ): s is a cubic that leaves 0 at θ₀, flat, and arrives at α₁ at the silhouette with slope m₁.
vec3 matcap_energy(MatcapHalf half_of, vec3 n) {
    float theta = atan(length(n.xy), n.z);
    float span = 1.5707963267948966 - half_of.silhouette.x;
    float t = clamp((theta - half_of.silhouette.x) / span, 0.0, 1.0);
    float added = half_of.silhouette.y * t * t * (3.0 - 2.0 * t) + half_of.silhouette.z * span * t * t * (t - 1.0);
    return max(half_of.base_colour + added, vec3(0.0));
}

// Columns and rows, 0 to 1, in the map of one side: +1 front, −1 back.
vec2 matcap_place(vec3 direction, float side) {
    vec2 disc = direction.xy / max(1.0 + side * direction.z, 1e-6);
    return vec2(0.5 + 0.5 * disc.x, 0.5 - 0.5 * disc.y);
}

// The normal of the picture that showed a direction; none, with z < 0, showed those beyond its rim.
vec3 matcap_source(MatcapHalf half_of, vec3 direction) {
    return matcap_warped(direction, 1.0 / (1.0 + half_of.slope) - 1.0);
}

// How much of a remainder is seen there.
float matcap_share(MatcapHalf half_of, vec3 source) {
    return source.z > -1e-6 ? half_of.remainder_share : 0.0;
}

vec3 matcap_maps(sampler2D front, sampler2D back, vec3 direction) {
    vec3 in_front = textureLod(front, matcap_place(direction, 1.0), 0.0).rgb;
    vec3 behind = textureLod(back, matcap_place(direction, -1.0), 0.0).rgb;
    return direction.z >= 0.0 ? in_front : behind;
}

vec3 matcap_light(MatcapHalf half_of, sampler2D front, sampler2D back, vec3 n) {
    return matcap_maps(front, back, matcap_seen(half_of, n)) * matcap_energy(half_of, n);
}

vec3 matcap_light(MatcapHalf half_of, sampler2D front, sampler2D back, sampler2D remainder, vec3 n) {
    vec3 direction = matcap_seen(half_of, n);
    vec3 source = matcap_source(half_of, direction);
    vec3 lacking = textureLod(remainder, vec2(0.5 + 0.5 * source.x, 0.5 - 0.5 * source.y), 0.0).rgb;
    vec3 light = matcap_maps(front, back, direction) + matcap_share(half_of, source) * lacking;
    return max(light, vec3(0.0)) * matcap_energy(half_of, n);
}
