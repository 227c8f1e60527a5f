// The point that lies nearest the pixel's ray, among those that the directions round it see.
//
// Porquet 2005 with the depth correction of Gortler et al. 1996; formulas (c): an answer to the parallax of half a step
// between directions. What a face sees from one direction is a relief over its texels. A ray of almost that direction
// runs through it, and meets it where it passes from before to behind (Policarpo, Oliveira & Comba 2005, after Tatarchuk
// 2006: a search in strides that no texel is missed by). Where the ray was never behind anything before it met the
// relief, no other direction could know better. Else something hides the ray from this direction, and the next is asked:
// the four of the face that the ray comes in by, then four of the face that looks most towards the eye.
// Symbols: t, metres along the ray from the face; SELECTION_STEPS, places a texel's parallax that the ray is looked at;
// selection_reach, farthest of a texel's line from the ray [texels of the longest side]; range, metres along the ray
// between which points may lie.
// No claim: what no direction round the ray sees stays unseen.

const float NOWHERE = 1.0e30;
const float STRIDES_MOST = 48.0; // through the box

// The four directions of a face round that of the eye, the nearest first, and the ray through their reliefs.
struct Looks {
    int face;
    vec3 to_eye;   // in the face's axes
    float before;  // depth below the face at which the ray begins, m
    vec2 scale;    // texels a metre
    ivec4 number;  // of each direction
    ivec4 layer;
    vec4 begin_u;  // texel of each relief at the ray's begin
    vec4 begin_v;
    vec4 drift_u;  // change along the ray, 1
    vec4 drift_v;
};

Looks looks_round(int face, vec3 place, vec3 to_eye) {
    Looks looks;
    looks.face = face;
    looks.to_eye = to_face(face, to_eye);
    looks.to_eye.z = max(looks.to_eye.z, 1.0e-4);
    vec4 weights;
    ivec4 round;
    vec4 u;
    vec4 v;
    hemisphere_slants(looks.to_eye, VIEW_AZIMUTHS, VIEW_ELEVATIONS, round, weights, u, v);
    bool upper = weights.x + weights.y < weights.z + weights.w;
    round = upper ? round.zwxy : round;
    u = upper ? u.zwxy : u;
    v = upper ? v.zwxy : v;
    bool right = weights.x + weights.z < weights.y + weights.w;
    looks.number = right ? round.yxwz : round;
    u = right ? u.yxwz : u;
    v = right ? v.yxwz : v;
    for (int k = 0; k < 4; k++) looks.layer[k] = texelFetch(seen_layer, ivec2(looks.number[k], face), 0).x;
    int axis = face / 2;
    looks.before = (face % 2 == 1 ? box_high[axis] - place[axis] : place[axis] - box_low[axis]);
    vec3 sides = box_high - box_low;
    looks.scale = float(TEXELS) / (face < 2 ? sides.yz : face < 4 ? sides.xz : sides.xy);
    vec2 at = face_coordinates(face, place) * float(TEXELS);
    looks.begin_u = at.x + looks.before * looks.scale.x * u;
    looks.begin_v = at.y + looks.before * looks.scale.y * v;
    looks.drift_u = looks.to_eye.z * u - looks.to_eye.x;
    looks.drift_v = looks.to_eye.z * v - looks.to_eye.y;
    return looks;
}

// How far a texel's line lies from the ray, as deep as it shows a point, m.
float apart_from(Looks looks, vec2 begin, vec2 drift, vec2 at, float surface) {
    vec2 offset = (at + 0.5 - begin - surface * drift) / looks.scale;
    float along = dot(offset, looks.to_eye.xy);
    return sqrt(max(dot(offset, offset) - along * along, 0.0));
}

// Where on the ray a texel (whole numbers) lies, m; nowhere where it is empty, and before everything where it is unknown.
float relief(Looks looks, int layer, vec2 at) {
    ivec2 texel = ivec2(at);
    ivec2 held = clamp(texel, ivec2(0), ivec2(TEXELS - 1));
    float depth = seen_depth_of(looks.face, layer, held);
    bool known = layer >= 0 && texel == held;
    return !known ? -NOWHERE : depth < 0.0 ? NOWHERE : (depth - looks.before) / looks.to_eye.z;
}

// The faces that look towards the eye: the one that the ray comes in by, then the others, that which looks more first.
ivec3 faces_towards(int face, vec3 to_eye) {
    int axis = face / 2;
    ivec2 others = axis == 0 ? ivec2(1, 2) : axis == 1 ? ivec2(0, 2) : ivec2(0, 1);
    others = abs(to_eye[others.x]) < abs(to_eye[others.y]) ? others.yx : others;
    return ivec3(face, 2 * others.x + (to_eye[others.x] > 0.0 ? 1 : 0), 2 * others.y + (to_eye[others.y] > 0.0 ? 1 : 0));
}

void selection_points(int face, vec3 place, vec3 to_eye, vec2 range, out uvec4 points, out vec4 weights) {
    vec3 sides = box_high - box_low;
    float texel = max(sides.x, max(sides.y, sides.z)) / float(TEXELS);
    float reach = selection_reach * texel;
    vec3 farther = max((box_low - place) / -to_eye, (box_high - place) / -to_eye);
    range.y = min(range.y, min(farther.x, min(farther.y, farther.z)));
    ivec3 faces = faces_towards(face, to_eye);
    float met = NOWHERE;
    bool sure = false;
    ivec3 spare = ivec3(-1); // texel and layer to take where nothing is better
    ivec3 taken = ivec3(-1);
    int turn = 0;
    do {
        Looks looks = looks_round(faces[turn], place, to_eye);
        bool news = false;
        int k = 0;
        do {
            vec2 begin = vec2(looks.begin_u[k], looks.begin_v[k]);
            vec2 drift = vec2(looks.drift_u[k], looks.drift_v[k]) * looks.scale;
            float stop = min(range.y, met);
            float texels = max(abs(drift.x), max(abs(drift.y), 1.0e-3)); // that the ray crosses in a metre
            float stride = max(1.0 / (texels * float(SELECTION_STEPS)), (stop - range.x) / STRIDES_MOST);
            float t = range.x;
            float ahead = t + stride;
            bool hidden = false;
            bool hit = false;
            do {
                t = min(ahead, stop);
                vec2 at = floor(begin + t * drift);
                float surface = relief(looks, looks.layer[k], at);
                bool behind = surface <= t;
                // Where the ray was as deep as the texel, it came before the relief, or the texel's edge hides what is there.
                vec2 over = floor(begin + (behind ? surface : t) * drift);
                float there = relief(looks, looks.layer[k], over);
                bool met_it = there <= t;
                at = met_it ? over : at;
                surface = met_it ? there : surface;
                bool close = behind && surface > -NOWHERE && apart_from(looks, begin, drift, at, surface) < reach;
                hit = close && met_it;
                spare = hit || (close && spare.z < 0) ? ivec3(at, looks.layer[k]) : spare;
                hidden = hidden || (behind && !hit);
                met = hit ? surface : met;
                // No farther than the texel itself lies: over its edge the ray may come to what lies behind.
                ahead = surface > t ? min(t + stride, surface) : t + stride;
            } while (!hit && t < stop);
            news = news || hit;
            sure = !hidden;
            k++;
        } while (!sure && k < 4);
        // Of what the four see there, that which lies nearest the ray.
        float best = news ? reach : 0.0;
        taken = news ? spare : taken;
        for (int j = 0; j < 4; j++) {
            vec2 begin = vec2(looks.begin_u[j], looks.begin_v[j]);
            vec2 drift = vec2(looks.drift_u[j], looks.drift_v[j]) * looks.scale;
            vec2 at = floor(begin + met * drift);
            float surface = relief(looks, looks.layer[j], at);
            float away = apart_from(looks, begin, drift, at, surface);
            bool better = abs(surface - met) < 2.0 * texel && away < best;
            best = better ? away : best;
            taken = better ? ivec3(at, looks.layer[j]) : taken;
        }
        turn++;
    } while (!sure && met == NOWHERE && turn < 3);
    taken = taken.z < 0 ? spare : taken;
    uint point = texelFetch(seen, max(taken, ivec3(0)), 0).x;
    points = uvec4(taken.z < 0 || sure && met == NOWHERE ? NO_POINT : point, uvec3(NO_POINT));
    weights = vec4(1.0, 0.0, 0.0, 0.0);
}
