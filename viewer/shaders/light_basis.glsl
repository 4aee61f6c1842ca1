// The functions of the light's direction that a material's value is a sum of; TERMS is how many there are.

#ifdef HSH

const float PI = 3.141592653589793;
const float LOWEST = 0.0099998333; // the sine of 0.01: lights are lifted that far off the horizon

// Hemispherical harmonics, by degree, and in each from cos mφ over m = 0 to sin mφ. No angle is needed: cos mφ and
// sin mφ follow from cos φ and sin φ.
void basis_of(vec3 light, out float values[TERMS]) {
    float c = clamp(light.z, LOWEST, 1.0);
    float flat_length = length(light.xy);
    vec2 one = flat_length > 0.0 ? light.xy / flat_length : vec2(1.0, 0.0);
    float s = c - c * c, q = sqrt(s);
    values[0] = inversesqrt(2.0 * PI);
    values[1] = sqrt(6.0 / PI) * q * one.x;
    values[2] = sqrt(1.5 / PI) * (2.0 * c - 1.0);
    values[3] = sqrt(6.0 / PI) * q * one.y;
#if TERMS > 4
    vec2 two = vec2(one.x * one.x - one.y * one.y, 2.0 * one.x * one.y);
    float outer = sqrt(30.0 / PI) * s, inner = sqrt(30.0 / PI) * (2.0 * c - 1.0) * q;
    values[4] = -outer * two.x;
    values[5] = inner * one.x;
    values[6] = sqrt(2.5 / PI) * (1.0 - 6.0 * s);
    values[7] = inner * one.y;
    values[8] = -outer * two.y;
#endif
#if TERMS > 9
    vec2 three = vec2(two.x * one.x - two.y * one.y, two.y * one.x + two.x * one.y);
    float third = sqrt(140.0 / PI) * s * q, second = -sqrt(210.0 / PI) * (2.0 * c - 1.0) * s;
    float first = sqrt(84.0 / PI) * q * (1.0 - 5.0 * s);
    values[9] = third * three.x;
    values[10] = second * two.x;
    values[11] = first * one.x;
    values[12] = sqrt(3.5 / PI) * (((20.0 * c - 30.0) * c + 12.0) * c - 1.0);
    values[13] = first * one.y;
    values[14] = second * two.y;
    values[15] = third * three.y;
#endif
}

#else

// Polynomials (Texture paper, equation 8): u², v², uv, u, v, 1; the last three alone if there are three.
void basis_of(vec3 light, out float values[TERMS]) {
#if TERMS == 6
    values[0] = light.x * light.x;
    values[1] = light.y * light.y;
    values[2] = light.x * light.y;
#endif
    values[TERMS - 3] = light.x;
    values[TERMS - 2] = light.y;
    values[TERMS - 1] = 1.0;
}

#endif
