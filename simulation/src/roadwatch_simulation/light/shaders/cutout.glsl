// Gaps between leaves, the same in every pass: cells of a grid in model axes, a leaf wide.
const float LEAF_M = 0.09;
const float GAP_SHARE = 0.28;

float cell_hash(vec3 cell) {
    uvec3 q = uvec3(ivec3(cell)) * uvec3(1597334673u, 3812015801u, 2798796415u);
    uint n = (q.x ^ q.y ^ q.z) * 1597334673u;
    return float(n >> 8) / 16777216.0;
}

bool is_gap(vec3 position) {
    vec3 slanted = position + 0.35 * LEAF_M * sin(position.yzx * 41.0);
    return cell_hash(floor(slanted / LEAF_M)) < GAP_SHARE;
}
