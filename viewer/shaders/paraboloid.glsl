// Reads dual paraboloid maps: the front and the back of all directions, row 0 at v = +1.

// Columns and rows, 0 to 1, in the map of one side: +1 front, −1 back.
vec2 paraboloid_place(vec3 direction, float side) {
    vec2 disc = direction.xy / max(1.0 + side * direction.z, 1e-6);
    return vec2(0.5 + 0.5 * disc.x, 0.5 - 0.5 * disc.y);
}

// Each map's own coordinates are smooth across the seam, so their change from pixel to pixel can be trusted there.
vec3 read_paraboloid(sampler2D front, sampler2D back, vec3 direction, float level, float trust) {
    vec2 in_front = paraboloid_place(direction, 1.0), in_back = paraboloid_place(direction, -1.0);
    vec2 front_x = dFdx(in_front) * trust, front_y = dFdy(in_front) * trust;
    vec2 back_x = dFdx(in_back) * trust, back_y = dFdy(in_back) * trust;
    if (direction.z >= 0.0)
        return level < 0.0 ? textureGrad(front, in_front, front_x, front_y).rgb : textureLod(front, in_front, level).rgb;
    return level < 0.0 ? textureGrad(back, in_back, back_x, back_y).rgb : textureLod(back, in_back, level).rgb;
}
