// SGGX microflakes with diffuse reflectance and transmittance. Heitz, Dupuy, Crassin & Dachsbacher 2015, "The SGGX microflake
// distribution", sections 4.5 (storage: roots of the diagonal, correlations) and 5.3 (diffuse flakes), equations 20 to 23 (visible flakes).
// Symbols: S the matrix; k, j, i a frame with i = v to_eye; s sun_direction; rho matter.albedo, tau matter.passed [-].
// Deviations: the mean over FLAKES fixed visible flakes in the place of random ones; the extinction along rays is not S's own.
// It does not claim leaves of which some lie flat and some everywhere: one ellipsoid stands for both.

const int FLAKES = 12;

// Points of a golden spiral, spread evenly over the unit disk, and the hemisphere's height above each.
const vec3 DISK[FLAKES] = vec3[FLAKES](
    vec3(0.2041241, 0.0000000, 0.9789450), vec3(-0.2606993, 0.2388219, 0.9354143), vec3(0.0399042, -0.4546878, 0.8897565),
    vec3(0.3285945, 0.4285934, 0.8416254), vec3(-0.6030114, -0.1066642, 0.7905694), vec3(0.5712250, -0.3633666, 0.7359801),
    vec3(-0.1910636, 0.7107471, 0.6770032), vec3(-0.3643790, -0.7015896, 0.6123724), vec3(0.7905567, 0.2887100, 0.5400617),
    vec3(-0.8224425, 0.3394923, 0.4564355), vec3(0.3964716, -0.8472368, 0.3535534), vec3(0.2929824, 0.9340742, 0.2041241));

// Two unit vectors across v and each other. Duff et al. 2017.
void across(vec3 v, out vec3 k, out vec3 j) {
    float side = v.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (side + v.z);
    float b = v.x * v.y * a;
    k = vec3(1.0 + side * v.x * v.x * a, side * b, -side * v.x);
    j = vec3(b, side + v.y * v.y * a, -v.y);
}

vec3 light_reflected(Matter matter, vec3 to_eye) {
    vec3 root = max(textureLod(light_spread, matter.place, matter.level).xyz, 0.01);
    // Flat flakes lean all the way: what rounding adds would leave them no area at all.
    vec3 lean = clamp(textureLod(light_lean, matter.place, matter.level).xyz * 2.0 - 1.0, -0.995, 0.995);
    vec3 own = root * root;
    vec3 shared_part = lean * root.xxy * root.yzz;
    mat3 S = mat3(own.x, shared_part.x, shared_part.y, shared_part.x, own.y, shared_part.z, shared_part.y, shared_part.z, own.z);
    vec3 k, j;
    across(to_eye, k, j);
    vec3 Si = S * to_eye;
    vec3 Sj = S * j;
    float ii = dot(to_eye, Si), ji = dot(j, Si), ki = dot(k, Si), jj = dot(j, Sj), kj = dot(k, Sj);
    float area = sqrt(max(jj * ii - ji * ji, 1e-10));
    float inverse = inversesqrt(max(ii, 1e-10));
    // Equations 20 to 23: the sphere that S makes an ellipsoid, its visible half spread over the disk.
    vec3 along_u = sqrt(max(determinant(S), 1e-12)) / area * k;
    vec3 along_v = inverse * (area * j - (ki * ji - kj * ii) / area * k);
    vec3 along_w = inverse * (ki * k + ji * j + ii * to_eye);
    float front = 0.0;
    float behind = 0.0;
    for (int n = 0; n < FLAKES; n++) {
        vec3 place = DISK[n];
        float lit = dot(normalize(place.x * along_u + place.y * along_v + place.z * along_w), sun_direction);
        front += max(lit, 0.0);
        behind += max(-lit, 0.0);
    }
    return INVERSE_PI / float(FLAKES) * (front * matter.albedo + behind * matter.passed);
}
