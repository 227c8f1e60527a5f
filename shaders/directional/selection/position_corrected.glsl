// The point that lies nearest the pixel's ray, among those that the directions round it see.
//
// Porquet 2005 with the depth correction of Gortler et al. 1996; formulas (c): an answer to the parallax of half a step
// between directions. What a face sees from one direction is a relief over its texels. A ray of almost that direction
// runs through it, from texel to texel (Amanatides & Woo 1987), and meets it where it comes as deep as the texel's point.
// Where it was never behind anything before, no other direction could know better. Else something hides the ray from
// this direction, and the next is asked: the four of the face that the ray comes in by, then those of the other faces
// that look towards the eye. Of the four, the texel whose line lies nearest the ray there gives the point.
// Symbols: selection_reach, how far the ray may pass behind a texel that no direction sees past [texels of the longest side];
// range, metres along the ray between which points may lie.
// No claim: what no direction round the ray sees stays unseen.

const float NOWHERE = 1.0e30;
const int CROSSED = 2 * TEXELS; // of a relief that a ray runs through: none crosses more
const float LEVEL = 1.0; // texels of depth within which two texels count as one surface

// What is read behind a loop is carried from turn to turn in it, here and below: drivers that draw on the CPU compute all
// else anew for rays that have left the loop, as long as others go on.

// The ray through the reliefs of four directions of a face, the nearest first.
struct Looks {
    int face;
    vec3 to_eye;   // in the face's axes
    float before;  // depth below the face at which the ray begins, m
    vec2 scale;    // texels a metre
    ivec4 layer;
    vec4 begin_u;  // texel of each relief at the ray's begin
    vec4 begin_v;
    vec4 drift_u;  // texels a metre of the ray
    vec4 drift_v;
};

Looks looks_round(int face, vec3 place, vec3 to_eye) {
    Looks looks;
    looks.face = face;
    looks.to_eye = to_face(face, to_eye);
    looks.to_eye.z = max(looks.to_eye.z, 1.0e-4);
    vec2 along;
    ivec2 cell = hemisphere_cell(looks.to_eye, VIEW_AZIMUTHS, VIEW_ELEVATIONS, along);
    cell.y = cell.y == VIEW_AZIMUTHS ? 0 : cell.y;
    ivec4 layer = texelFetch(seen_round, ivec2(cell.x * VIEW_AZIMUTHS + cell.y, face), 0);
    vec4 u;
    vec4 v;
    hemisphere_slants(cell, VIEW_AZIMUTHS, VIEW_ELEVATIONS, u, v);
    bool upper = along.x > 0.5;
    layer = upper ? layer.zwxy : layer;
    u = upper ? u.zwxy : u;
    v = upper ? v.zwxy : v;
    bool right = along.y > 0.5;
    looks.layer = right ? layer.yxwz : layer;
    u = right ? u.yxwz : u;
    v = right ? v.yxwz : v;
    int axis = face / 2;
    looks.before = face % 2 == 1 ? box_high[axis] - place[axis] : place[axis] - box_low[axis];
    vec3 sides = box_high - box_low;
    looks.scale = float(TEXELS) / (face < 2 ? sides.yz : face < 4 ? sides.xz : sides.xy);
    vec2 at = face_coordinates(face, place) * float(TEXELS);
    looks.begin_u = at.x + looks.before * looks.scale.x * u;
    looks.begin_v = at.y + looks.before * looks.scale.y * v;
    looks.drift_u = looks.scale.x * (looks.to_eye.z * u - looks.to_eye.x);
    looks.drift_v = looks.scale.y * (looks.to_eye.z * v - looks.to_eye.y);
    return looks;
}

// The same with the next direction first.
void look_on(inout Looks looks) {
    looks.layer = looks.layer.yzwx;
    looks.begin_u = looks.begin_u.yzwx;
    looks.begin_v = looks.begin_v.yzwx;
    looks.drift_u = looks.drift_u.yzwx;
    looks.drift_v = looks.drift_v.yzwx;
}

// Square of the distance of two lines towards the eye that are `offset` texels apart on the face, m^2.
float apart(Looks looks, vec2 offset) {
    vec2 across = offset / looks.scale;
    float along = dot(across, looks.to_eye.xy);
    return dot(across, across) - along * along;
}

// Where on the ray a texel (whole numbers) lies, m; nowhere where it is empty, and before everything where it is unknown.
float relief(Looks looks, int layer, vec2 at) {
    vec2 held = clamp(at, 0.0, float(TEXELS - 1));
    float depth = seen_depth_of(looks.face, layer, ivec2(held));
    bool known = layer >= 0 && at == held;
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
    float slack = LEVEL * texel;
    vec3 farther = max((box_low - place) / -to_eye, (box_high - place) / -to_eye);
    range.y = min(range.y, min(farther.x, min(farther.y, farther.z)));
    ivec3 faces = faces_towards(face, to_eye);
    float met = NOWHERE;
    bool sure = false;
    ivec3 taken = ivec3(-1); // texel and layer
    int turn = 0;
    do {
        Looks looks = looks_round(faces[turn], place, to_eye);
        bool news = false;
        int k = 0;
        do {
            vec2 begin = vec2(looks.begin_u.x, looks.begin_v.x);
            vec2 drift = vec2(looks.drift_u.x, looks.drift_v.x);
            drift += vec2(equal(drift, vec2(0.0))) * 1.0e-6;
            float stray = sqrt(max(apart(looks, drift), 0.0)); // of the relief's lines from the ray, a metre of it
            float stop = min(range.y, met);
            vec2 onward = sign(drift);
            vec2 border = step(0.0, drift) - begin;
            vec2 at = floor(begin + range.x * drift);
            float t = range.x;
            bool hidden = false;
            bool hit = false;
            int count = 0;
            do {
                // The ray is over this texel from t to the nearer of its borders.
                vec2 borders = (at + border) / drift;
                float surface = relief(looks, looks.layer.x, at);
                float until = min(borders.x, borders.y);
                hit = hit || (surface <= until && surface >= t - slack);
                bool behind = surface < t && !hit;
                hidden = hidden || behind;
                // Just behind a texel's edge: what is taken where nothing is known better.
                bool close = behind && taken.z < 0 && (t - surface) * stray < reach;
                taken = hit || close ? ivec3(at, looks.layer.x) : taken;
                met = hit ? surface : met;
                t = max(until, t);
                at += borders.x < borders.y ? vec2(onward.x, 0.0) : vec2(0.0, onward.y);
                count++;
            } while (!hit && t < stop && count < CROSSED);
            news = news || hit;
            sure = sure || (!hidden && (hit || t >= stop));
            look_on(looks);
            k++;
        } while (!sure && k < 4);
        // Of the four, the texel whose line lies nearest the ray there, if it sees the same.
        vec4 at_u = floor(looks.begin_u + met * looks.drift_u);
        vec4 at_v = floor(looks.begin_v + met * looks.drift_v);
        vec4 off_u = (at_u + 0.5 - looks.begin_u - met * looks.drift_u) / looks.scale.x;
        vec4 off_v = (at_v + 0.5 - looks.begin_v - met * looks.drift_v) / looks.scale.y;
        vec4 off = off_u * looks.to_eye.x + off_v * looks.to_eye.y;
        off = off_u * off_u + off_v * off_v - off * off;
        bool second = off.y < off.x;
        vec4 best = second ? vec4(at_u.y, at_v.y, looks.layer.y, off.y) : vec4(at_u.x, at_v.x, looks.layer.x, off.x);
        best = off.z < best.w ? vec4(at_u.z, at_v.z, looks.layer.z, off.z) : best;
        best = off.w < best.w ? vec4(at_u.w, at_v.w, looks.layer.w, off.w) : best;
        bool same = abs(relief(looks, int(best.z), best.xy) - met) < slack;
        taken = news && same ? ivec3(best.xyz) : taken;
        turn++;
    } while (!sure && met == NOWHERE && turn < 3);
    bool none = taken.z < 0 || (sure && met == NOWHERE);
    points = uvec4(none ? NO_POINT : texelFetch(seen, max(taken, ivec3(0)), 0).x, uvec3(NO_POINT));
    weights = vec4(1.0, 0.0, 0.0, 0.0);
}
