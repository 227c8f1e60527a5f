// Leaves as thin sheets that reflect and let through like Lambert's paper: the reflectance of the reference itself.
// Ross 1981, The radiation regime and architecture of plant stands, II.2 and II.3; Shultis & Myneni 1988, section 2 (bi-Lambertian leaves).
// Symbols: rho matter.albedo, tau matter.passed [-]; n matter.normal; kappa matter.flatness [-]; s sun_direction; v to_eye; b the angle
// between s and v. A voxel's leaves are a share kappa lying flat across n and a share 1 - kappa facing everywhere alike, so that the mean
// of their normals is the stored one; each is seen by its projected area |m.v| and lit by |m.s|.
// Deviations: a mixture of two distributions in the place of the leaves' own; the extinction along rays does not know it.
// It does not claim a shining cuticle, nor that leaves shade each other within a voxel beyond its opacity.

// Both sides' integrals over leaves facing everywhere (Ross 1981): seen and lit on one side (1/(4 pi) times the integral of |m.v||m.s|
// over the m that see both or neither) is (sin b + (pi - b) cos b) / (3 pi), on opposite sides (sin b - b cos b) / (3 pi).
vec3 light_reflected(Matter matter, vec3 to_eye) {
    float lit = dot(matter.normal, sun_direction);
    float seen = dot(matter.normal, to_eye);
    float cosine = clamp(dot(sun_direction, to_eye), -1.0, 1.0);
    float angle = acos(cosine);
    float sine = sqrt(1.0 - cosine * cosine);
    float same = (sine + (3.141592653589793 - angle) * cosine) * INVERSE_PI / 3.0;
    float other = (sine - angle * cosine) * INVERSE_PI / 3.0;
    vec3 flat_leaves = abs(seen * lit) * (seen * lit > 0.0 ? matter.albedo : matter.passed);
    vec3 all = mix(same * matter.albedo + other * matter.passed, flat_leaves, matter.flatness);
    return all * INVERSE_PI / max(mix(0.5, abs(seen), matter.flatness), 1e-4);
}
