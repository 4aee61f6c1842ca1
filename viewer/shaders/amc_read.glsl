// Reads tables of pre-lit colour at a fragment (the AMC paper, section 6).

#include "common.glsl"
#include "amc_place.glsl"

uniform float level;     // mip level to read; below 0: the one that fits
uniform bool seam_trick;

const float EDGE_ON = 0.2;

// Texture coordinates, and how they change from pixel to pixel.
struct Reading {
    vec3 coordinates;
    vec3 along_x;
    vec3 along_y;
};

// On a triangle seen nearly edge-on a pixel's neighbours are extrapolated far past its corners, the farther the more it
// is turned away, and the silhouette would be read from levels that are much too small.
Reading trusted(vec3 coordinates, vec3 along_x, vec3 along_y, Meaning meaning) {
    vec3 to_eye = direction_to_eye();
    float trust = min(1.0, dot(visible_normal(to_eye), to_eye) / EDGE_ON);
    vec3 repeated = vec3(1.0, 1.0, meaning.repeats);
    vec3 texels = coordinates * repeated + vec3(0.0, 0.0, meaning.first_slice);
    return Reading(texels, along_x * repeated * trust, along_y * repeated * trust);
}

// k jumps from 1 to 0 somewhere, its twin k' half a turn away; both are the same place in the table. Where one jumps,
// the card would take the jump for minification, so the change from pixel to pixel is that of the one which changes
// less (section 6.2, per fragment). Handing over the change itself, not k or k' for the card to difference, matters:
// the four pixels of a quad need not choose alike.
float change(float of_k, float of_k_prime) {
    return seam_trick && abs(of_k_prime) < abs(of_k) ? of_k_prime : of_k;
}

Reading reading_of(Meaning meaning) {
    vec3 to_eye = direction_to_eye();
    vec3 n = visible_normal(to_eye);
    vec3 place = table_place(n, tangent_in_plane(n), to_eye, meaning);
    float twin = twin_of(place.z);
    vec3 along_x = vec3(dFdx(place.xy), change(dFdx(place.z), dFdx(twin)));
    vec3 along_y = vec3(dFdy(place.xy), change(dFdy(place.z), dFdy(twin)));
    return trusted(place, along_x, along_y, meaning);
}

vec3 read_table(sampler3D table, Reading at) {
    return level < 0.0 ? textureGrad(table, at.coordinates, at.along_x, at.along_y).rgb
                       : textureLod(table, at.coordinates, level).rgb;
}
