in vec2 in_corner;
uniform mat3 world_from_corner;
out vec3 ray;
void main() {
    ray = world_from_corner * vec3(in_corner, 1.0);
    gl_Position = vec4(in_corner, 1.0, 1.0);
}
