#if !MASK
flat in uint part;
#endif
#if CUTOUT
#include "cutout.glsl"
in vec3 model_position;
#endif
#if !MASK
uniform int object_id;
layout(location = 0) out uvec2 ids;
#else
layout(location = 0) out vec4 mask;
#endif
void main() {
#if CUTOUT
    if (is_gap(model_position)) discard;
#endif
#if !MASK
    ids = uvec2(uint(object_id), object_id > 0 ? part : 0u);
#else
    mask = vec4(1.0);
#endif
}
