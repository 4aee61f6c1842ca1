#version 330 core

#include "mesh.glsl"

void main() {
    place_vertex();
}
