// A tabulated reflectance between its nodes. Porquet 2005, section 3.3.2.2; errata 003-4.
//
// Bilinear in the light for each of the neighbouring view directions (C_a, C_b, C of the paper), then bilinear in the
// view: five interpolations of 16 values with both azimuths, three of 8 with three coordinates. Twin:
// renderer/directional/brdf/lookup.py; what the textures hold: resident.py beside it.
// Symbols: theta from the normal, phi from the tangent [rad]; values [sr-1]. Azimuths wrap; beyond the last theta its
// value stands.

// TABLE_COORDINATES: 0 angles, 1 with the difference of azimuths, 2 by the half vector. TABLE_VIEWS: view nodes, 2 or 4.
const float TABLE_RIGHT_ANGLE = 1.57079632679490;

// Angle of (x, y), y not negative, to float32's precision (Cephes, atanf); a driver's own may be off by 1e-4.
float table_angle(float y, float x) {
    float along = abs(x), great = max(along, y), small = min(along, y);
    float ratio = great > 0.0 ? small / great : 0.0;
    bool steep = ratio > 0.414213562;
    float t = steep ? (ratio - 1.0) / (ratio + 1.0) : ratio, z = t * t;
    float angle = (steep ? 0.785398163 : 0.0) + t
        + t * z * (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1);
    angle = y > along ? TABLE_RIGHT_ANGLE - angle : angle;
    return x < 0.0 ? 2.0 * TABLE_RIGHT_ANGLE - angle : angle;
}

float table_azimuth(vec2 level) {
    float angle = table_angle(abs(level.y), level.x);
    return level.y < 0.0 ? -angle : angle;
}

float table_theta(vec3 direction) {
    return table_angle(length(direction.xy), direction.z);
}

// Coordinates of a pair of unit vectors in the surface's frame.
vec4 table_place(vec3 view, vec3 light) {
    view = normalize(vec3(view.xy, max(view.z, 0.0)));
    light = normalize(vec3(light.xy, max(light.z, 0.0)));
#if TABLE_COORDINATES == 2
    vec3 half_way = normalize(view + light);
    float level = length(half_way.xy);
    vec2 outward = level > 0.0 ? half_way.xy / level : vec2(1.0, 0.0);
    vec3 turned = vec3(dot(light, vec3(half_way.z * outward, -level)),
                       dot(light.xy, vec2(-outward.y, outward.x)), dot(light, half_way));
    return vec4(sqrt(table_theta(half_way) / TABLE_RIGHT_ANGLE), 0.0, table_theta(turned), table_azimuth(turned.xy));
#elif TABLE_COORDINATES == 1
    vec2 turned = vec2(dot(view.xy, light.xy), view.x * light.y - view.y * light.x);
    return vec4(table_theta(view), 0.0, table_theta(light), table_azimuth(turned));
#else
    return vec4(table_theta(view), table_azimuth(view.xy), table_theta(light), table_azimuth(light.xy));
#endif
}

// Numbers of the nodes before and after a place on an axis, and how far it is from one to the other.
ivec2 table_between(int axis, float at, out float share) {
    vec4 said = table_axes[axis];
    float along = at - said.x;
    along = said.y > 0.0 ? along - said.y * floor(along / said.y) : clamp(along, 0.0, said.z - said.x);
    vec4 bin = texelFetch(light_rulers, ivec2(int(along * said.w), axis), 0);
    bool before = along < bin.z;
    share = before ? 1.0 - (bin.z - along) * bin.y : (along - bin.z) * bin.w;
    int node = int(bin.x) + (before ? 0 : 1), count = table_nodes[axis];
    return ivec2(node < count ? node : 0, node + 1 < count ? node + 1 : 0);
}

// Bilinear in the light, for one view node.
vec3 table_light(ivec2 corner, ivec2 theta, ivec2 phi, vec2 share) {
    vec3 c0 = texelFetch(light_table, corner + ivec2(phi.x, theta.x), 0).rgb;
    vec3 c1 = texelFetch(light_table, corner + ivec2(phi.x, theta.y), 0).rgb;
    vec3 c2 = texelFetch(light_table, corner + ivec2(phi.y, theta.y), 0).rgb;
    vec3 c3 = texelFetch(light_table, corner + ivec2(phi.y, theta.x), 0).rgb;
    vec3 ca = c0 + share.y * (c3 - c0);
    vec3 cb = c1 + share.y * (c2 - c1);
    return ca + share.x * (cb - ca);
}

// Reflectance [sr-1] of unit vectors in the surface's frame.
vec3 table_reflectance(vec3 view, vec3 light) {
    vec4 place = table_place(view, light), share;
    ivec2 theta_o = table_between(0, place.x, share.x), phi_o = table_between(1, place.y, share.y);
    ivec2 theta_l = table_between(2, place.z, share.z), phi_l = table_between(3, place.w, share.w);
    vec3 sum = vec3(0.0);
    for (int number = 0; number < TABLE_VIEWS; number++) {
        bool second_theta = (number & 1) == 1, second_phi = number > 1;
        int tile = (second_theta ? theta_o.y : theta_o.x) * table_nodes.y + (second_phi ? phi_o.y : phi_o.x);
        float weight = (second_theta ? share.x : 1.0 - share.x) * (second_phi ? share.y : 1.0 - share.y);
        ivec2 corner = ivec2(tile % table_across, tile / table_across) * table_nodes.wz;
        sum += weight * table_light(corner, theta_l, phi_l, share.zw);
    }
    return sum;
}
