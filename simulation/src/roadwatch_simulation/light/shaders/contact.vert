in vec2 in_corner;
uniform mat4 clip_from_model;
uniform vec2 half_size;
uniform float spread;
uniform float lift;
out vec2 place;
void main() {
    place = in_corner * (half_size + spread);
    gl_Position = clip_from_model * vec4(place, lift, 1.0);
}
