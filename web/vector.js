// Three-vectors as arrays, and the world's angles: azimuth clockwise from north (x east, y north), degrees outside.

const DEGREE = Math.PI / 180;

export const radians = (degrees) => degrees * DEGREE;
export const degrees = (angle) => angle / DEGREE;
export const add = (a, b, scale = 1) => a.map((value, i) => value + scale * b[i]);
export const scaled = (a, factor) => a.map((value) => value * factor);
export const length = (a) => Math.hypot(...a);
export const normalised = (a) => scaled(a, 1 / (length(a) || 1));
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Unit vector of an azimuth and elevation in degrees. */
export function direction(azimuth, elevation) {
  const [a, e] = [radians(azimuth), radians(elevation)];
  return [Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), Math.sin(e)];
}

/** Azimuth in [0, 360) and elevation, in degrees, of a vector. */
export function angles(vector) {
  const [x, y, z] = normalised(vector);
  return { azimuth: wrap(degrees(Math.atan2(x, y))), elevation: degrees(Math.asin(Math.max(-1, Math.min(1, z)))) };
}

/** An angle in degrees brought into [0, 360). */
export function wrap(angle) {
  return ((angle % 360) + 360) % 360;
}
