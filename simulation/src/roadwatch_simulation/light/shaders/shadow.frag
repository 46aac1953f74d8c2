#if CUTOUT
#include "cutout.glsl"
in vec3 model_position;
#endif
void main() {
#if CUTOUT
    if (is_gap(model_position)) discard;
#endif
}
