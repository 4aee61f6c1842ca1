// Display values and linear light (IEC 61966-2-1). Nothing is cut off: below 0 both go on straight.

vec3 decode_srgb(vec3 v) {
    return mix(pow((max(v, vec3(0.0)) + 0.055) / 1.055, vec3(2.4)), v / 12.92, lessThanEqual(v, vec3(0.04045)));
}

vec3 encode_srgb(vec3 light) {
    vec3 curve = 1.055 * pow(max(light, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055;
    return mix(curve, light * 12.92, lessThanEqual(light, vec3(0.0031308)));
}
