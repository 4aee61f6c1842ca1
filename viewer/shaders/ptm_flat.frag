#version 330 core

// A PTM as the picture that it is, texel by texel. Row 0 of the textures is drawn at the bottom, and is read back first.

#include "polynomial.glsl"

uniform vec2 light; // x and y of the unit vector to the light

out vec4 value;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 c[6];
    for (int term = 0; term < 6; ++term) c[term] = texelFetch(coefficients, ivec3(texel, term), 0).rgb;
    vec3 p = polynomial(c, light);
    value = vec4(is_luminance ? p.r * texelFetch(luminance_colour, texel, 0).rgb : p, 1.0);
}
