in vec3 in_position;
in vec3 in_normal;
in uint in_tag;
uniform mat4 clip_from_model;
uniform mat4 world_from_model;
uniform float foot_z;
uniform bool is_mirrored;
out vec3 world_position;
out vec3 world_normal;
out vec3 model_position;
flat out uint material;

void main() {
    world_position = (world_from_model * vec4(in_position, 1.0)).xyz;
    world_normal = mat3(world_from_model) * in_normal;
    model_position = in_position;
    material = in_tag & 0xffffu;
    // While mirrored ground is drawn, kerbs and all below them stay out of it.
    gl_ClipDistance[0] = is_mirrored ? world_position.z - foot_z - 0.03 : 1.0;
    gl_Position = clip_from_model * vec4(in_position, 1.0);
}
