in vec2 place;
uniform vec3 glow;
layout(location = 0) out vec4 colour;
void main() {
    float fall = max(1.0 - length(place), 0.0);
    colour = vec4(glow * (0.75 * pow(fall, 6.0) + 0.30 * fall * fall), 1.0);
}
