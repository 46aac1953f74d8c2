in vec2 place;
uniform vec2 half_size;
uniform float spread;
uniform float below;
uniform float beside;
layout(location = 0) out vec4 colour;
void main() {
    vec2 inset = max(half_size - 0.12, vec2(0.05));
    vec2 past = abs(place) - inset;
    float outside = length(max(past, 0.0));
    float inside = max(-max(past.x, past.y), 0.0);
    float near = 1.0 - smoothstep(0.0, spread + 0.12, outside);
    float dark = mix(beside * near * near, below, smoothstep(0.0, 0.25, inside));
    dark = max(dark, beside * near * near);
    colour = vec4(vec3(1.0 - dark), 1.0);
}
