// Where a camera's rays run and where a place lies in its picture: the twin of the server's cameras. Pure functions.

import { add, cross, direction, normalised, radians, scaled } from "./vector.js";

const RETREAT = 10;
const NEAREST = 1e-3;

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** Eye and unit vectors forward, right and up of a camera. */
export function axes(camera) {
  if (camera.kind === "orbit") {
    const outward = direction(camera.azimuth, camera.elevation);
    const azimuth = radians(camera.azimuth);
    const right = [-Math.cos(azimuth), Math.sin(azimuth), 0];
    const forward = scaled(outward, -1);
    return { eye: add(camera.target, outward, camera.distance), forward, right, up: cross(right, forward) };
  }
  const free = camera.kind === "look";
  const forward = normalised(free ? add(camera.target, camera.eye, -1) : camera.direction);
  const eye = free ? camera.eye : add(camera.centre, forward, -RETREAT * camera.width);
  const right = normalised(cross(forward, camera.up));
  return { eye, forward, right, up: cross(right, forward) };
}

/** Origin and unit direction of the ray through a point of the picture, `x` and `y` in [0, 1] from its top-left corner. */
export function ray(camera, aspect, x, y) {
  const { eye, forward, right, up } = axes(camera);
  if (camera.kind === "orthographic") {
    const across = add(scaled(right, (x - 0.5) * camera.width), up, ((0.5 - y) * camera.width) / aspect);
    return { origin: add(eye, across), way: forward };
  }
  const half = Math.tan(radians(camera.field_of_view) / 2);
  return { origin: eye, way: normalised(add(add(forward, right, (2 * x - 1) * half * aspect), up, (1 - 2 * y) * half)) };
}

/** Column-major matrix to clip coordinates of places that are counted from `centre` and lie within `radius` of it. */
export function matrix(camera, aspect, centre, radius) {
  const { eye, forward, right, up } = axes(camera);
  const at = add(eye, centre, -1);
  const row = (axis, factor) => [...scaled(axis, factor), -factor * dot(axis, at)];
  const middle = -dot(forward, at);
  const near = Math.max(middle - radius, NEAREST * radius);
  const far = Math.max(middle + radius, 2 * NEAREST * radius);
  const ahead = row(forward, 1);
  const whole = [0, 0, 0, 1];
  const flat = camera.kind === "orthographic";
  const half = flat ? camera.width / 2 / aspect : Math.tan(radians(camera.field_of_view) / 2);
  const depth = flat
    ? ahead.map((value, i) => (2 * value - (far + near) * whole[i]) / (far - near))
    : ahead.map((value, i) => ((far + near) * value - 2 * far * near * whole[i]) / (far - near));
  const rows = [row(right, 1 / (half * aspect)), row(up, 1 / half), depth, flat ? whole : ahead];
  return new Float32Array([0, 1, 2, 3].flatMap((column) => rows.map((line) => line[column])));
}

/**
 * The first triangle that a ray meets, or null: its number and the weights of its corners there.
 * `positions` holds three numbers a vertex, `faces` three vertices a triangle, `shift` is added to each of these.
 */
export function meet({ origin, way }, positions, faces, shift = 0) {
  let nearest = Infinity;
  let found = null;
  const [ox, oy, oz] = origin;
  const [wx, wy, wz] = way;
  for (let face = 0; face < faces.length; face += 3) {
    const a = 3 * (faces[face] + shift);
    const b = 3 * (faces[face + 1] + shift);
    const c = 3 * (faces[face + 2] + shift);
    const [ax, ay, az] = [positions[a], positions[a + 1], positions[a + 2]];
    const [px, py, pz] = [positions[b] - ax, positions[b + 1] - ay, positions[b + 2] - az];
    const [qx, qy, qz] = [positions[c] - ax, positions[c + 1] - ay, positions[c + 2] - az];
    const [hx, hy, hz] = [wy * qz - wz * qy, wz * qx - wx * qz, wx * qy - wy * qx];
    const area = px * hx + py * hy + pz * hz;
    if (area === 0) continue;
    const [sx, sy, sz] = [ox - ax, oy - ay, oz - az];
    const v = (sx * hx + sy * hy + sz * hz) / area;
    if (v < 0 || v > 1) continue;
    const [kx, ky, kz] = [sy * pz - sz * py, sz * px - sx * pz, sx * py - sy * px];
    const w = (wx * kx + wy * ky + wz * kz) / area;
    if (w < 0 || v + w > 1) continue;
    const away = (qx * kx + qy * ky + qz * kz) / area;
    if (away > 0 && away < nearest) {
      nearest = away;
      found = { face: face / 3, weights: [1 - v - w, v, w], normal: [py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx] };
    }
  }
  return found;
}

/** The place at weights of a triangle's corners. */
export function placeAt({ face, weights }, positions, faces, shift = 0) {
  return weights.reduce((sum, weight, i) => {
    const vertex = 3 * (faces[3 * face + i] + shift);
    return add(sum, positions.subarray(vertex, vertex + 3), weight);
  }, [0, 0, 0]).map(Number);
}
