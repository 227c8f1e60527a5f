// Moving the camera: what a drag, a pinch or a key means for each kind of camera. Pure functions from camera to patch.

import { add, angles, cross, direction, length, normalised, radians, scaled, wrap } from "./vector.js";

const TURN = 180;
const STEEPEST = 89;
const FLIGHT = 300;
const RISE = 0.25;
const NEARBY = 1000;
const UPWARDS = 0.1;
const FIELD_OF_VIEW = 40;

const level = (angle) => Math.max(-STEEPEST, Math.min(STEEPEST, angle));
const vertical = (ahead) => Math.abs(ahead[2]) > 0.999;

/** What every kind says in its own way: unit vector of the view, the point looked at, metres from there to the eye. */
function pose(camera) {
  if (camera.kind === "orbit") return { ahead: scaled(direction(camera.azimuth, camera.elevation), -1), target: camera.target, distance: camera.distance };
  if (camera.kind === "orthographic") return { ahead: normalised(camera.direction), target: camera.centre };
  const sight = add(camera.target, camera.eye, -1);
  return { ahead: normalised(sight), target: camera.target, distance: length(sight) };
}

/** Metres that a flying camera is up: the higher, the faster it flies, or space would be hours away. */
const height = (camera) => Math.abs(camera.eye[2]);

/** Metres spanned by the picture's height where the camera looks. */
function reach(camera, aspect) {
  if (camera.kind === "orthographic") return camera.width / aspect;
  return 2 * pose(camera).distance * Math.tan(radians(camera.field_of_view) / 2);
}

const rightOf = (camera, ahead) => normalised(cross(ahead, vertical(ahead) ? (camera.up ?? [0, 1, 0]) : [0, 0, 1]));

/** The patch that shifts a camera by a vector. */
function shifted(camera, move) {
  const points = { orbit: ["target"], look: ["eye", "target"], orthographic: ["centre"] }[camera.kind];
  return Object.fromEntries(points.map((name) => [name, add(camera[name], move)]));
}

/** Turn: about the target (orbit), on the spot (look), or about the centre (orthographic). `dx`, `dy` in picture heights. */
export function turn(camera, dx, dy) {
  if (camera.kind === "orbit") return { azimuth: wrap(camera.azimuth + dx * TURN), elevation: level(camera.elevation + dy * TURN) };
  const { ahead, distance } = pose(camera);
  const view = angles(ahead);
  const speed = camera.kind === "look" ? -camera.field_of_view : TURN;
  const turned = direction(view.azimuth + dx * speed, level(view.elevation - dy * speed));
  return camera.kind === "look" ? { target: add(camera.eye, turned, distance) } : { direction: turned, up: [0, 0, 1] };
}

/** Shift the camera with the picture, so that the ground follows the pointer. */
export function pan(camera, dx, dy, aspect) {
  const { ahead } = pose(camera);
  const right = rightOf(camera, ahead);
  const size = reach(camera, aspect);
  return shifted(camera, add(scaled(right, -dx * size), cross(right, ahead), dy * size));
}

/**
 * Zoom by a factor: less than 1 comes closer. Near its target a flying camera flies on through it; far from it, it keeps it in
 * view, and retreats upwards, not into the ground behind.
 */
export function zoom(camera, factor) {
  if (camera.kind === "orbit") return { distance: camera.distance * factor };
  if (camera.kind === "orthographic") return { width: camera.width * factor };
  const { ahead, distance } = pose(camera);
  const way = distance * (1 - factor);
  if (distance < NEARBY) return shifted(camera, scaled(ahead, way));
  return { eye: add(camera.eye, factor > 1 ? [ahead[0], ahead[1], Math.min(-Math.abs(ahead[2]), -UPWARDS)] : ahead, way) };
}

/** Fly for `seconds` along right, ahead and up, each in [-1, 1]; all but a camera that looks round stays level. */
export function fly(camera, rightward, onward, upward, seconds, aspect) {
  const { ahead } = pose(camera);
  const free = camera.kind === "look";
  const right = rightOf(camera, ahead);
  const speed = free ? Math.max(Math.min(FLIGHT, reach(camera, aspect)), height(camera) * RISE) : reach(camera, aspect) * 0.6;
  const on = free ? ahead : normalised([ahead[0], ahead[1], 0]);
  return shifted(camera, scaled(add(add(scaled(right, rightward), on, onward), [0, 0, 1], upward), speed * seconds));
}

/** The nearest camera of another kind, so that changing the kind keeps the view. */
export function converted(camera, kind, aspect) {
  const { ahead, target } = pose(camera);
  const size = reach(camera, aspect);
  const fov = camera.field_of_view ?? FIELD_OF_VIEW;
  const distance = size / (2 * Math.tan(radians(fov) / 2));
  const { azimuth, elevation } = angles(scaled(ahead, -1));
  return {
    orbit: { kind, target, distance, azimuth, elevation: level(elevation), field_of_view: fov },
    look: { kind, eye: add(target, ahead, -distance), target, up: [0, 0, 1], field_of_view: fov },
    orthographic: { kind, centre: target, direction: ahead, up: vertical(ahead) ? [0, 1, 0] : [0, 0, 1], width: size * aspect },
  }[kind];
}
