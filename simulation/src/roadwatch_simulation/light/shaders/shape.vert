// Only the shape: for ids, silhouettes and shadows.
in vec3 in_position;
#if !MASK
in uint in_tag;
flat out uint part;
#endif
uniform mat4 clip_from_model;
#if CUTOUT
out vec3 model_position;
#endif
void main() {
#if !MASK
    part = in_tag >> 16;
#endif
#if CUTOUT
    model_position = in_position;
#endif
    gl_Position = clip_from_model * vec4(in_position, 1.0);
}
