#version 330 core

// What was drawn, as a display shows it: averaged over `finer`² pixels, laid over a plain background in linear light, and
// sRGB encoded.

uniform sampler2D drawn; // linear light, straight coverage
uniform int finer;
uniform vec3 background; // linear light

out vec4 colour;

vec3 encode_srgb(vec3 v) {
    return mix(1.055 * pow(v, vec3(1.0 / 2.4)) - 0.055, v * 12.92, lessThanEqual(v, vec3(0.0031308)));
}

void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) * finer;
    vec4 sum = vec4(0.0); // of light weighted by coverage, and of coverage
    for (int y = 0; y < finer; ++y) {
        for (int x = 0; x < finer; ++x) {
            vec4 part = texelFetch(drawn, first + ivec2(x, y), 0);
            // What does not cover may hold anything.
            if (part.a > 0.0) sum += vec4(part.rgb * part.a, part.a);
        }
    }
    sum /= float(finer * finer);
    colour = vec4(encode_srgb(clamp(background * (1.0 - sum.a) + sum.rgb, 0.0, 1.0)), 1.0);
}
