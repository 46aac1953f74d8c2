in vec3 in_position;
in vec3 in_normal;
in uint in_tag;
uniform mat4 clip_from_model;
uniform mat4 world_from_model;
out vec3 world_position;
out vec3 world_normal;
out vec3 model_position;
flat out uint material;

void main() {
    world_position = (world_from_model * vec4(in_position, 1.0)).xyz;
    world_normal = mat3(world_from_model) * in_normal;
    model_position = in_position;
    material = in_tag & 0xffffu;
    gl_Position = clip_from_model * vec4(in_position, 1.0);
}
