// Moving the camera: what a drag, a pinch or a key means for each kind of camera. Pure functions from camera to patch.

import { add, angles, cross, direction, length, normalised, radians, scaled, wrap } from "./vector.js";

const TURN = 180;
const STEEPEST = 89;
const FLIGHT = 300;

const clampElevation = (value) => Math.max(-STEEPEST, Math.min(STEEPEST, value));

/** Right and up vectors of the picture, and the size in metres of one picture height at the point looked at. */
function frame(camera) {
  const ahead = forward(camera);
  const helper = Math.abs(ahead[2]) > 0.999 ? (camera.up ?? [0, 1, 0]) : [0, 0, 1];
  const right = normalised(cross(ahead, helper));
  return { ahead, right, up: cross(right, ahead) };
}

/** Unit vector along the view. */
export function forward(camera) {
  if (camera.kind === "orbit") return scaled(direction(camera.azimuth, camera.elevation), -1);
  if (camera.kind === "look") return normalised(add(camera.target, camera.eye, -1));
  return normalised(camera.direction);
}

/** Where the eye is; for an orthographic camera, far enough back along the view. */
export function eye(camera) {
  if (camera.kind === "orbit") return add(camera.target, direction(camera.azimuth, camera.elevation), camera.distance);
  if (camera.kind === "look") return camera.eye;
  return add(camera.centre, normalised(camera.direction), -camera.width);
}

/** Metres spanned by the picture's height where the camera looks. */
function reach(camera, aspect) {
  if (camera.kind === "orthographic") return camera.width / aspect;
  const distance = camera.kind === "orbit" ? camera.distance : length(add(camera.target, camera.eye, -1));
  return 2 * distance * Math.tan(radians(camera.field_of_view) / 2);
}

/** Turn: about the target (orbit), on the spot (look), or about the centre (orthographic). `dx`, `dy` in picture heights. */
export function turn(camera, dx, dy) {
  if (camera.kind === "orbit") {
    return { azimuth: wrap(camera.azimuth + dx * TURN), elevation: clampElevation(camera.elevation + dy * TURN) };
  }
  const view = angles(forward(camera));
  const speed = camera.kind === "look" ? -camera.field_of_view : TURN;
  const ahead = direction(view.azimuth + dx * speed, clampElevation(view.elevation - dy * speed));
  if (camera.kind === "orthographic") return { direction: ahead, up: [0, 0, 1] };
  return { target: add(camera.eye, ahead, length(add(camera.target, camera.eye, -1))) };
}

/** Shift the camera with the picture, so that the ground follows the pointer. */
export function pan(camera, dx, dy, aspect) {
  const { right, up } = frame(camera);
  const size = reach(camera, aspect);
  const move = add(scaled(right, -dx * size), up, dy * size);
  if (camera.kind === "orbit") return { target: add(camera.target, move) };
  if (camera.kind === "orthographic") return { centre: add(camera.centre, move) };
  return { eye: add(camera.eye, move), target: add(camera.target, move) };
}

/** Zoom by a factor: less than 1 comes closer. */
export function zoom(camera, factor) {
  if (camera.kind === "orbit") return { distance: camera.distance * factor };
  if (camera.kind === "orthographic") return { width: camera.width * factor };
  const move = scaled(add(camera.target, camera.eye, -1), 1 - factor);
  return { eye: add(camera.eye, move), target: add(camera.target, move) };
}

/** Fly for `seconds` along right, ahead and up, each in [-1, 1]. */
export function fly(camera, rightward, onward, upward, seconds, aspect) {
  const { ahead, right } = frame(camera);
  const speed = camera.kind === "look" ? Math.min(FLIGHT, reach(camera, aspect)) : reach(camera, aspect) * 0.6;
  const level = camera.kind === "look" ? ahead : normalised([ahead[0], ahead[1], 0]);
  const move = scaled(add(add(scaled(right, rightward), level, onward), [0, 0, 1], upward), speed * seconds);
  if (camera.kind === "orbit") return { target: add(camera.target, move) };
  if (camera.kind === "orthographic") return { centre: add(camera.centre, move) };
  return { eye: add(camera.eye, move), target: add(camera.target, move) };
}

/** The nearest camera of another kind, so that changing the kind keeps the view. */
export function converted(camera, kind, aspect) {
  const ahead = forward(camera);
  const size = reach(camera, aspect);
  const fov = camera.field_of_view ?? 40;
  const distance = size / (2 * Math.tan(radians(fov) / 2));
  const target = camera.target ?? camera.centre;
  if (kind === "orbit") {
    const back = angles(scaled(ahead, -1));
    return { kind, target, distance, azimuth: back.azimuth, elevation: clampElevation(back.elevation), field_of_view: fov };
  }
  if (kind === "look") return { kind, eye: add(target, ahead, -distance), target, up: [0, 0, 1], field_of_view: fov };
  return { kind, centre: target, direction: ahead, up: Math.abs(ahead[2]) > 0.999 ? [0, 1, 0] : [0, 0, 1], width: size * aspect };
}
