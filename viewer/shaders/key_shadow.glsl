// Where the key light reaches the surface (the AMC paper, section 6.1), by a shadow map.

uniform sampler2DShadow key_depth; // nearest surface along the key light, orthographic
uniform mat4 map_from_view;        // to 0..1 in all three
uniform vec3 key_direction;        // unit, view frame, from the surface to the light
uniform float key_offset;          // a map texel or so: how far a point is lifted off its surface before it is compared

// 1 where it is lit, 0 in shadow. On a slope a texel of the map spans depths in proportion to the tangent of its
// angle to the light; lifted along its normal by the sine of that angle, a point clears just as much.
float key_reaches(vec3 n) {
    float facing = dot(n, key_direction);
    if (facing <= 0.0) return 0.0;
    vec3 lifted = view_position + n * (key_offset * (0.1 + sqrt(1.0 - min(1.0, facing * facing))));
    return texture(key_depth, (map_from_view * vec4(lifted, 1.0)).xyz);
}
