// The first sample of a picture: the sun is looked for once a block of pixels, and what is lit is smoothed between neighbours alike.
// Dammertz, Sewtz, Hanika & Lensch 2010 (edge-stopping weights); Kopf, Cohen, Lischinski & Uyttendaele 2007 (joint bilateral upsampling).
// Symbols: looked share of the sun, distance [m] and height of the one ray of each block, and its pixel's number in it; LOOK pixels a side of a block;
// lit radiance and distance of what each pixel met, -1 where it met nothing; traced_place distance and height of each pixel's own.
// Later samples look for the sun at every pixel and are added as they are: the first one's share of a converged picture is 1 / n.

#if LOOK > 0

// Distances [m] this much apart, and this share of their own, count half.
const float ALIKE_NEAR = 2.0;
const float ALIKE_SHARE = 0.02;

// Heights in the canopy this much apart count half: the sun fails with the depth in it.
const float ALIKE_HEIGHT = 0.2;

float alike(float t, float other) {
    float apart = (t - other) / (ALIKE_NEAR + ALIKE_SHARE * t);
    return 1.0 / (1.0 + apart * apart);
}

// Height in the canopy, of wood too; the ground counts as a canopy's height below it.
float height_of(float found) {
    return found >= WOOD ? found - WOOD : found;
}

// The pixel of a block whose ray looks for the sun: the first that met something, from another corner in each block.
ivec2 looking_pixel(ivec2 block, out vec2 found, out float number) {
    ivec2 pixel = ivec2(0);
    found = vec2(0.0, NOTHING);
    number = 0.0;
    for (int k = 0; k < LOOK * LOOK && found.y == NOTHING; k++) {
        int n = (k + 5 * block.x + 7 * block.y) % (LOOK * LOOK);
        number = float(n);
        pixel = min(block * LOOK + ivec2(n % LOOK, n / LOOK), ivec2(picture_size) - 1);
        found = texelFetch(traced_place, pixel, 0).rg;
    }
    return pixel;
}

// Share of the sun at this pixel, from the nine blocks around it; each ray looked from its own pixel.
float looked_visibility() {
    vec2 own = texelFetch(traced_place, ivec2(gl_FragCoord.xy), 0).rg;
    ivec2 block = ivec2(gl_FragCoord.xy) / LOOK;
    ivec2 last = textureSize(looked, 0) - 1;
    vec2 sum = vec2(0.0, 1e-9);
    for (int n = 0; n < 9; n++) {
        ivec2 at = clamp(block + ivec2(n % 3, n / 3) - 1, ivec2(0), last);
        vec4 other = texelFetch(looked, at, 0);
        vec2 away = gl_FragCoord.xy - vec2(at * LOOK) - 0.5 - vec2(mod(other.a, float(LOOK)), floor(other.a / float(LOOK)));
        float near = 1.0 / (1.0 + dot(away, away) / float(LOOK * LOOK));
        float apart = (height_of(own.y) - height_of(other.z)) / ALIKE_HEIGHT;
        float weight = other.z == NOTHING ? 0.0 : near * near * alike(own.x, other.y) / (1.0 + apart * apart);
        sum += weight * vec2(other.x, 1.0);
    }
    return sum.x / sum.y;
}

// What is lit, smoothed over three by three pixels of what lies at about the same distance, and its distance [m], which stays its
// own; of a ray that shows too little to have one, that of the pixels beside it, -1 where they have none.
vec4 smoothed(ivec2 pixel) {
    float own = texelFetch(lit, pixel, 0).a;
    ivec2 last = ivec2(picture_size) - 1;
    vec4 sum = vec4(0.0);
    float weights = 1e-9;
    for (int n = 0; n < 9; n++) {
        ivec2 step = ivec2(n % 3, n / 3) - 1;
        vec4 other = texelFetch(lit, clamp(pixel + step, ivec2(0), last), 0);
        float weight = other.a < 0.0 ? 0.0 : own < 0.0 ? 1.0 : alike(own, other.a);
        sum += weight * other;
        weights += weight;
    }
    sum /= weights;
    return vec4(sum.rgb, own >= 0.0 ? own : sum.a > 0.0 ? sum.a : -1.0);
}

// What was smoothed of one ray for two by two pixels, linear between the rays: row 0 of `smooth_lit` is its lowest, where the
// blocks of pixels are counted from the top.
vec4 spread_out(vec2 pixel) {
    ivec2 size = textureSize(smooth_lit, 0);
    vec2 place = vec2(0.5 * pixel.x, float(size.y) - 0.5 * pixel.y) - 0.5;
    vec2 part = fract(place);
    ivec2 low = ivec2(floor(place));
    vec4 row[2];
    for (int n = 0; n < 2; n++) {
        ivec2 at = clamp(low + ivec2(0, n), ivec2(0), size - 1);
        ivec2 beside = clamp(low + ivec2(1, n), ivec2(0), size - 1);
        row[n] = mix(texelFetch(smooth_lit, at, 0), texelFetch(smooth_lit, beside, 0), part.x);
    }
    return mix(row[0], row[1], part.y);
}
#endif
