#version 330 core

// One colour.

uniform vec3 plain_colour;

out vec4 colour;

void main() {
    colour = vec4(plain_colour, 1.0);
}
