// A polynomial texture map's value under a light (Texture paper, equation 8).

uniform sampler2DArray coefficients; // six layers: u², v², uv, u, v, 1
uniform sampler2D luminance_colour;  // the factor of the luminance in an LRGB PTM
uniform bool is_luminance;

vec3 polynomial(vec3 c[6], vec2 light) {
    vec3 value = c[0] * (light.x * light.x) + c[1] * (light.y * light.y) + c[2] * (light.x * light.y);
    return value + c[3] * light.x + c[4] * light.y + c[5];
}
