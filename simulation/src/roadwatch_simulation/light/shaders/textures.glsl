// How each kind of surface varies. One kind is compiled into each program: SURFACE is model.Surface.
#define PLAIN 0
#define ASPHALT 1
#define GRASS 2
#define PAVING 3
#define PLASTER 4
#define BRICK 5
#define FOLIAGE 6
#define CLOTH 7

struct Look {
    vec3 colour;
    float gloss;
    vec3 bump;
};

// Noise at a place, given in repeats of the texture; detail finer than the pixel is averaged away.
vec4 noise_at(vec2 place_m, float repeats_per_m, float footprint_m) {
    float lod = log2(max(footprint_m * repeats_per_m * 512.0, 1.0));
    return textureLod(noise, place_m * repeats_per_m, lod);
}

vec2 along_surface(vec3 place, vec3 normal) {
    vec2 wall = vec2(dot(place.xy, normalize(vec2(-normal.y, normal.x) + 1e-5)), place.z);
    return abs(normal.z) > 0.7 ? place.xy : wall;
}

float hash2(vec2 cell) {
    uvec2 q = uvec2(ivec2(cell)) * uvec2(1597334673u, 3812015801u);
    return float(((q.x ^ q.y) * 1597334673u) >> 8) / 16777216.0;
}

// 1 on a line of a grid, softened to the pixel's footprint and gone where lines are finer than pixels.
float grid_line(float place_in_cells, float line_share, float footprint_in_cells) {
    float gap = abs(fract(place_in_cells) - 0.5);
    float soft = max(footprint_in_cells, 0.01);
    float line = smoothstep(0.5 - line_share * 0.5 - soft, 0.5 - line_share * 0.5 + soft, gap);
    return mix(line, line_share, smoothstep(0.25, 0.7, footprint_in_cells));
}

Look look_of(vec3 base, float gloss, vec3 world, vec3 model, vec3 normal, float footprint) {
    Look look = Look(base, gloss, vec3(0.0));
#if SURFACE == ASPHALT
    vec2 p = world.xy;
    vec4 broad = noise_at(p, 0.011, footprint);
    vec4 middle = noise_at(p + 7.3, 0.093, footprint);
    vec4 fine = noise_at(p, 0.55, footprint);
    float grain = noise_at(p, 9.0, footprint).g;
    float shade = 0.76 + 0.26 * broad.r + 0.12 * (middle.a - 0.5) + 0.10 * (fine.a - 0.5) + 0.40 * (grain - 0.5);
    vec2 patch_cell = floor(vec2(p.x / 7.0 + broad.a, p.y / 2.6 + broad.r));
    shade *= 1.0 - 0.20 * step(0.86, hash2(patch_cell)) * smoothstep(0.2, 0.4, middle.r);
    float crack = noise_at(p, 0.045, footprint).b;
    shade *= mix(1.0, crack, 0.34 * smoothstep(0.45, 0.75, broad.a));
    shade *= 1.0 - 0.30 * smoothstep(0.78, 0.95, middle.r) * smoothstep(0.4, 0.7, broad.r);
    look.colour = base * shade * mix(vec3(1.03, 1.0, 0.96), vec3(0.97, 1.0, 1.04), broad.a);
    look.gloss = gloss + 0.10 * broad.r;
    look.bump = vec3(fine.a - 0.5, middle.a - 0.5, 0.0) * 0.10;
#elif SURFACE == GRASS
    vec2 p = world.xy;
    vec4 broad = noise_at(p, 0.015, footprint);
    vec4 fine = noise_at(p, 0.31, footprint);
    float blades = noise_at(p * vec2(1.0, 0.6), 4.0, footprint).g;
    vec3 dry = base * vec3(2.1, 1.45, 1.1);
    look.colour = mix(base, dry, smoothstep(0.45, 0.95, broad.a * 0.6 + fine.r * 0.5));
    look.colour *= 0.55 + 0.5 * fine.a + 0.7 * (blades - 0.35);
    look.bump = vec3(blades - 0.5, fine.a - 0.5, 0.0) * 0.5;
#elif SURFACE == PAVING
    vec2 p = along_surface(world, normal);
    vec2 cells = p / vec2(0.50, 0.50);
    float soft = footprint / 0.50;
    float joint = max(grid_line(cells.x, 0.05, soft), grid_line(cells.y, 0.05, soft));
    float tile = mix(hash2(floor(cells)), 0.5, smoothstep(0.3, 1.0, soft));
    vec4 broad = noise_at(p, 0.04, footprint);
    float grain = noise_at(p, 6.0, footprint).g;
    look.colour = base * (0.74 + 0.18 * tile + 0.26 * broad.r + 0.22 * (grain - 0.5)) * (1.0 - 0.45 * joint);
#elif SURFACE == PLASTER
    vec2 p = along_surface(world, normal);
    vec4 broad = noise_at(p, 0.021, footprint);
    float streak = noise_at(p * vec2(1.0, 0.12), 0.35, footprint).a;
    float grain = noise_at(p, 3.0, footprint).g;
    look.colour = base * (0.80 + 0.22 * broad.r + 0.16 * (streak - 0.5) + 0.14 * (grain - 0.5));
    look.colour *= 0.82 + 0.18 * smoothstep(0.0, 1.6, world.z);
#elif SURFACE == BRICK
    vec2 p = along_surface(world, normal);
    float row = floor(p.y / 0.075);
    vec2 cells = vec2(p.x / 0.24 + 0.5 * mod(row, 2.0), p.y / 0.075);
    float joint = max(grid_line(cells.x, 0.06, footprint / 0.24), grid_line(cells.y, 0.16, footprint / 0.075));
    float brick = mix(hash2(floor(cells)), 0.5, smoothstep(0.2, 0.8, footprint / 0.12));
    vec4 broad = noise_at(p, 0.03, footprint);
    look.colour = mix(base * (0.66 + 0.46 * brick + 0.22 * (broad.r - 0.5)), vec3(0.34, 0.32, 0.29), joint * 0.7);
#elif SURFACE == FOLIAGE
    float leaf = hash2(floor(model.xy / 0.09) + floor(model.z / 0.09) * 57.0);
    float clump = noise_at(model.xy + model.zx * 0.7, 0.16, footprint).r;
    float near_leaf = mix(leaf, 0.5, smoothstep(0.06, 0.3, footprint));
    look.colour = base * (0.35 + 0.75 * near_leaf + 0.65 * clump) * mix(vec3(1.0), vec3(1.35, 1.1, 0.7), near_leaf * near_leaf);
    vec3 cell = floor(model / 0.09);
    look.bump = (vec3(hash2(cell.xy + cell.z), hash2(cell.yz + cell.x * 3.0), hash2(cell.zx + cell.y * 7.0)) - 0.5) * 1.1;
#elif SURFACE == CLOTH
    vec2 p = along_surface(model, normal);
    vec4 folds = noise_at(p * vec2(1.0, 0.45), 0.7, footprint);
    float weave = noise_at(p, 9.0, footprint).g;
    look.colour = base * (0.72 + 0.40 * folds.r + 0.16 * (weave - 0.5));
    look.bump = vec3(folds.a - 0.5, folds.r - 0.5, 0.0) * 0.7;
#endif
    return look;
}
