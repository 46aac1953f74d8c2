#include "shading.glsl"
#include "cutout.glsl"
in vec3 world_position;
in vec3 world_normal;
in vec3 model_position;
flat in uint material;
layout(location = 0) out vec4 colour;

void main() {
#if SURFACE == FOLIAGE
    if (is_gap(model_position)) discard;
#endif
    colour = vec4(developed(radiance_of(world_position, world_normal, model_position, material)), 1.0);
}
