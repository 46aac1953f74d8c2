// Sky, clouds and a made-up horizon, for the background and for all that mirrors.
uniform sampler2D noise;
uniform vec3 sun_direction;
uniform vec3 sun_colour;
uniform vec3 zenith_colour;
uniform vec3 horizon_colour;
uniform vec3 cloud_colour;
uniform vec3 ground_colour;
uniform vec3 band_colour;
uniform float cloud_cover;
uniform vec2 cloud_offset;
uniform float exposure;

const float HORIZON_DETAIL = 0.75;

vec3 sky_radiance(vec3 direction, float blur) {
    float up = clamp(direction.z, 0.0, 1.0);
    vec3 clear_sky = mix(horizon_colour, zenith_colour, pow(up, 0.45));
    vec2 plane = direction.xy / (up + 0.10) * 0.045 + cloud_offset;
    float density = textureLod(noise, plane, blur * 5.0).r + textureLod(noise, plane * 3.7, blur * 6.0).a * 0.36 - 0.18;
    float cloud = smoothstep(1.0 - cloud_cover, 1.0 - cloud_cover + 0.30, density) * smoothstep(0.01, 0.12, up);
    float lining = 0.82 + 0.36 * smoothstep(0.9, 0.4, density);
    vec3 colour = mix(clear_sky, cloud_colour * lining, cloud * 0.9);
    float near_sun = max(dot(direction, sun_direction), 0.0);
    float glow = pow(near_sun, 48.0) * 0.30 + pow(near_sun, 6.0) * 0.05;
    return colour + sun_colour * glow * (1.0 - 0.6 * cloud);
}

// What a surface mirrors: sky above, dark buildings and trees along the horizon, ground below.
vec3 environment(vec3 direction, float blur) {
    float turn = atan(direction.y, direction.x) * 0.1592 + cloud_offset.x;
    float blocks = textureLod(noise, vec2(turn * HORIZON_DETAIL, 0.37), 1.0 + 4.0 * blur).r;
    float leaves = textureLod(noise, vec2(turn * 6.0, direction.z), 1.0 + 4.0 * blur).a;
    float height = 0.03 + 0.34 * blocks * blocks + 0.05 * leaves;
    float soft = 0.015 + 0.30 * blur;
    float over = smoothstep(height - soft, height + soft, direction.z);
    vec3 band = band_colour * (0.55 + 0.9 * leaves);
    vec3 upper = mix(band, sky_radiance(vec3(direction.xy, max(direction.z, 0.0)), blur), over);
    return mix(ground_colour, upper, smoothstep(-0.02 - soft, 0.01 + soft * 0.4, direction.z));
}

// Filmic curve (the ACES fit of K. Narkowicz, 2015), then display gamma.
vec3 developed(vec3 radiance) {
    vec3 x = radiance * exposure;
    x = (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14);
    return pow(clamp(x, 0.0, 1.0), vec3(1.0 / 2.2));
}

// The radiance that `developed` turns into a colour; white comes back as bright, not as endless.
vec3 undeveloped(vec3 shown) {
    vec3 y = pow(clamp(shown, 0.0, 0.96), vec3(2.2));
    vec3 a = 2.43 * y - 2.51;
    vec3 b = 0.59 * y - 0.03;
    return (-b - sqrt(b * b - 0.56 * a * y)) / (2.0 * a) / exposure;
}
