#include "sky.glsl"
in vec3 ray;
layout(location = 0) out vec4 colour;
uniform float haze_per_m;

// The last of the ground fades into the horizon at this distance.
const float EDGE_M = 1200.0;

void main() {
    vec3 direction = normalize(ray);
    vec3 sky = sky_radiance(vec3(direction.xy, max(direction.z, 0.0)), 0.0);
    sky += sun_colour * 8.0 * smoothstep(0.99985, 0.99995, dot(direction, sun_direction));
    float veil = exp(-max(direction.z, 0.0) * 22.0) * (1.0 - exp(-haze_per_m * EDGE_M));
    sky = mix(sky, horizon_colour, veil);
    colour = vec4(developed(direction.z < 0.0 ? mix(horizon_colour, ground_colour, smoothstep(0.0, -0.08, direction.z)) : sky), 1.0);
}
