// The light that a place on a surface sends to the eye.
#include "sky.glsl"
#include "textures.glsl"
uniform sampler2D materials;
uniform sampler2DShadow shadow_map;
uniform mat4 near_from_world;
uniform mat4 far_from_world;
uniform vec2 shadow_texel_m;
uniform float shadow_texel;
uniform vec3 eye;
uniform vec3 ambient_up;
uniform vec3 ambient_down;
uniform float haze_per_m;
uniform float wetness;
uniform float lamps;
uniform float pixel_angle;
// Half length, half width, height of a vehicle's cuboid; zero for everything else.
uniform vec3 body;
uniform float foot_z;

bool inside(vec3 place) {
    return all(greaterThan(place, vec3(0.004))) && all(lessThan(place, vec3(0.996)));
}

// Share of the sun that arrives; both maps lie side by side in one texture.
float sunlight(vec3 place, vec3 normal) {
    vec3 near_place = (near_from_world * vec4(place + normal * shadow_texel_m.x * 1.6, 1.0)).xyz * 0.5 + 0.5;
    vec3 far_place = (far_from_world * vec4(place + normal * shadow_texel_m.y * 1.6, 1.0)).xyz * 0.5 + 0.5;
    bool is_near = inside(near_place);
    vec3 at = is_near ? near_place : far_place;
    if (!is_near && !inside(far_place)) return 1.0;
    vec2 uv = vec2(at.x * 0.5 + (is_near ? 0.0 : 0.5), at.y);
    vec2 step_uv = vec2(0.5, 1.0) * shadow_texel * (is_near ? 1.3 : 0.8);
    float depth = at.z - 0.0003;
    float lit = texture(shadow_map, vec3(uv, depth)) * 0.28;
    lit += texture(shadow_map, vec3(uv + step_uv * vec2(1.0, 0.4), depth)) * 0.18;
    lit += texture(shadow_map, vec3(uv + step_uv * vec2(-0.4, 1.0), depth)) * 0.18;
    lit += texture(shadow_map, vec3(uv + step_uv * vec2(-1.0, -0.4), depth)) * 0.18;
    lit += texture(shadow_map, vec3(uv + step_uv * vec2(0.4, -1.0), depth)) * 0.18;
    return lit;
}

// Light from all around that reaches a place: less near the ground, little in wheel arches and under the floor.
float openness(vec3 world_position, vec3 model_position, vec3 normal) {
    float height = world_position.z - foot_z;
    float open = mix(0.48, 1.0, smoothstep(-0.05, 0.75, height));
    open = mix(open, 1.0, smoothstep(0.4, 0.95, normal.z));
    vec2 depth_in = body.xy - abs(model_position.xy);
    float inner = smoothstep(0.05, 0.26, min(depth_in.x, depth_in.y));
    float low = 1.0 - smoothstep(0.30, 0.52, model_position.z / max(body.z, 0.1));
    return open * (1.0 - 0.88 * inner * low * step(0.1, body.z));
}

#if WET
uniform sampler2D mirrored;
uniform vec2 drawn_size_px;

// The scene as the ground mirrors it, over the surroundings' own light; rough ground smears it upwards.
vec3 mirrored_scene(vec3 surroundings, vec2 bump, float puddle) {
    vec2 place = gl_FragCoord.xy / drawn_size_px + bump * 0.02 * (1.0 - puddle);
    float level = mix(2.6, 0.6, puddle);
    vec2 smear = vec2(0.0, mix(0.022, 0.003, puddle));
    vec4 seen = textureLod(mirrored, place, level) * 0.4;
    seen += (textureLod(mirrored, place + smear, level) + textureLod(mirrored, place - smear, level)) * 0.3;
    return surroundings * (1.0 - seen.a) + undeveloped(seen.rgb / max(seen.a, 0.01)) * seen.a;
}
#endif

vec3 radiance_of(vec3 world_position, vec3 world_normal, vec3 model_position, uint material) {
    vec3 to_eye = eye - world_position;
    float distance_m = length(to_eye);
    vec3 view = to_eye / distance_m;
    vec3 normal = normalize(world_normal);
    normal = dot(normal, view) < 0.0 ? -normal : normal;
    vec4 first = texelFetch(materials, ivec2(int(material), 0), 0);
    vec4 second = texelFetch(materials, ivec2(int(material), 1), 0);
    float facing = max(dot(normal, view), 0.0);
    float footprint = distance_m * pixel_angle * inversesqrt(max(facing, 0.04));
    Look look = look_of(first.rgb, first.a, world_position, model_position, normal, footprint);
    vec3 shaded = normalize(normal + look.bump);
    float metallic = second.y;

    float open = openness(world_position, model_position, normal);
    vec3 ambient = mix(ambient_down, ambient_up, shaded.z * 0.5 + 0.5) * open;
    float toward_sun = max(dot(shaded, sun_direction), 0.0);
#if SURFACE == FOLIAGE
    toward_sun = 0.25 + 0.75 * toward_sun;
#endif
#if SUNNY
    vec3 sun = sun_colour * sunlight(world_position, normal);
#else
    vec3 sun = vec3(0.0);
#endif
    vec3 diffuse = look.colour * (1.0 - metallic);
    vec3 mirror = mix(vec3(second.x), look.colour, metallic);
    float gloss = look.gloss;
    float grazing = pow(1.0 - facing, 5.0);
#if WET
    float flat_ground = smoothstep(0.85, 0.97, normal.z) * wetness;
    float puddle = smoothstep(0.42, 0.80, noise_at(world_position.xy, 0.043, footprint).r);
    puddle *= 0.75 + 0.25 * noise_at(world_position.xy, 0.4, footprint).a;
    diffuse *= 1.0 - 0.52 * flat_ground;
    gloss = mix(gloss, 0.60 + 0.36 * puddle, flat_ground);
    shaded = normalize(mix(shaded, normal + look.bump * 0.12 * (1.0 - puddle), flat_ground));
#endif
    mirror *= 1.0 + 0.6 * smoothstep(0.5, 0.8, gloss) * (1.0 - metallic);
    vec3 fresnel = mirror + (max(vec3(gloss), mirror) - mirror) * grazing;
    vec3 radiance = diffuse * (ambient + sun * toward_sun) * (1.0 - fresnel);
#if GLOSSY
    vec3 bounce = reflect(-view, shaded);
    float blur = (1.0 - gloss) * (1.0 - gloss);
    vec3 seen = environment(bounce, blur) * mix(0.4, 1.0, open);
#if WET
    seen = mix(seen, mirrored_scene(seen, look.bump.xy, puddle), flat_ground);
#endif
    radiance += fresnel * seen * smoothstep(0.05, 0.35, gloss);
    float power = exp2(1.0 + 10.0 * gloss);
    float lobe = pow(max(dot(bounce, sun_direction), 0.0), power) * (power + 8.0) * 0.04;
    radiance += sun * fresnel * min(lobe, 60.0);
#endif
    radiance += first.rgb * second.z * mix(1.0, lamps, second.w);
    radiance = mix(radiance, horizon_colour, 1.0 - exp(-distance_m * haze_per_m));
    return radiance;
}
