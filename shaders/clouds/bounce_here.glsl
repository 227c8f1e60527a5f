// What is at a place: first irradiance of the ground [W m-2], the ground's albedo, the reflectance of the base above.
struct BounceHere {
    vec3 irradiance;
    vec3 albedo;
    vec3 reflectance;
};
