in vec2 in_corner;
uniform mat4 clip_from_world;
uniform vec3 center;
uniform vec3 right;
uniform vec3 up;
out vec2 place;
void main() {
    place = in_corner;
    gl_Position = clip_from_world * vec4(center + right * in_corner.x + up * in_corner.y, 1.0);
}
