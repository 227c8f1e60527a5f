// Lines over the picture: edges of a shell's cells and the brush, drawn by the browser with the camera of the picture shown.

import { matrix } from "./projection.js";
import { add, cross, normalised, scaled } from "./vector.js";

const VERTEX = `attribute vec3 place; uniform mat4 view; uniform vec2 shift;
void main() { gl_Position = view * vec4(place, 1.0); gl_Position.xy += shift * gl_Position.w; }`;
const FRAGMENT = "precision mediump float; uniform vec4 colour; void main() { gl_FragColor = vec4(colour.rgb * colour.a, colour.a); }";
const DENSEST = 2;
const RING = 40;
const HIDDEN = 0.2;
const THICK = [[0, 0], [1, 0], [0, 1], [1, 1]];

/** What each sort of line is called, and how it looks: red, green, blue, opacity, whether thick. */
export const SORTS = {
  surface: ["Surface", [0.45, 0.75, 1, 0.75]],
  top: ["Top of the shell", [1, 1, 1, 0.75]],
  upright: ["Offsets", [0.65, 0.95, 0.65, 0.6]],
  side: ["Between tetrahedra", [0.85, 0.65, 1, 0.4]],
  before: ["In conflict before", [1, 0.85, 0.35, 0.75]],
  shorter: ["Shorter than wanted", [0.3, 0.85, 1, 1], true],
  conflict: ["In conflict", [1, 0.25, 0.15, 1], true],
};
const KINDS = ["surface", "top", "upright", "side"];
const MARKS = [["conflict", 4], ["shorter", 8], ["before", 16]];

/** A canvas between the picture and the pointer. */
export class Lines {
  constructor(root, before) {
    this.root = root;
    this.canvas = document.createElement("canvas");
    this.canvas.className = "lines";
    this.canvas.setAttribute("aria-hidden", "true");
    root.insertBefore(this.canvas, before);
    this.gl = this.canvas.getContext("webgl", { antialias: true, premultipliedAlpha: true });
    this.canvas.addEventListener("webglcontextlost", (event) => { event.preventDefault(); this.gl = null; });
    if (this.gl) this.compile();
  }

  compile() {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "place");
    gl.linkProgram(program);
    gl.useProgram(program);
    this.where = Object.fromEntries(["view", "shift", "colour"].map((name) => [name, gl.getUniformLocation(program, name)]));
    this.wide = gl.getExtension("OES_element_index_uint");
    this.buffers = {};
    gl.enableVertexAttribArray(0);
    gl.enable(gl.BLEND);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Whether this browser can draw them. */
  get able() {
    return Boolean(this.gl && this.wide);
  }

  fill(name, target, data) {
    const { gl } = this;
    this.buffers[name] ??= { held: gl.createBuffer() };
    gl.bindBuffer(target, this.buffers[name].held);
    gl.bufferData(target, data, gl.DYNAMIC_DRAW);
    this.buffers[name].count = data.length;
  }

  /** Take what a shell is built of; places are counted from its middle, or they would lose their digits. */
  take({ positions, faces, ends, marks }) {
    const low = [Infinity, Infinity, Infinity];
    const high = low.map((value) => -value);
    positions.forEach((value, i) => {
      low[i % 3] = Math.min(low[i % 3], value);
      high[i % 3] = Math.max(high[i % 3], value);
    });
    this.centre = scaled(add(low, high), 0.5);
    this.radius = Math.hypot(...add(high, low, -1)) / 2 || 1;
    if (!this.able) return;
    const { gl } = this;
    this.fill("places", gl.ARRAY_BUFFER, positions.map((value, i) => value - this.centre[i % 3]));
    this.fill("faces", gl.ELEMENT_ARRAY_BUFFER, faces);
    const chosen = Object.fromEntries(Object.keys(SORTS).map((name) => [name, []]));
    marks.forEach((mark, i) => {
      const pair = [ends[2 * i], ends[2 * i + 1]];
      chosen[KINDS[mark & 3]].push(...pair);
      for (const [name, bit] of MARKS) if (mark & bit) chosen[name].push(...pair);
    });
    this.counts = Object.fromEntries(Object.entries(chosen).map(([name, list]) => [name, list.length / 2]));
    for (const [name, list] of Object.entries(chosen)) this.fill(name, gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(list));
  }

  /**
   * Draw the sorts of lines named, and rings `{at, normal, radius, colour}`; what the surface hides is faint.
   * `camera` null clears.
   */
  draw(camera, sorts, rings = []) {
    if (!this.able) return;
    const { gl, canvas } = this;
    const box = this.root.getBoundingClientRect();
    const ratio = Math.min(DENSEST, window.devicePixelRatio || 1);
    const [width, height] = [Math.max(1, Math.round(box.width * ratio)), Math.max(1, Math.round(box.height * ratio))];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!camera || !this.centre) return;
    gl.uniformMatrix4fv(this.where.view, false, matrix(camera, width / height, this.centre, 1.05 * this.radius));
    this.places("places");
    this.hide();
    for (const name of sorts) {
      const [, colour, thick] = SORTS[name];
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers[name].held);
      this.stroke(colour, thick, [width, height], () => gl.drawElements(gl.LINES, this.buffers[name].count, gl.UNSIGNED_INT, 0));
    }
    for (const ring of rings) this.ring(ring, [width, height]);
  }

  places(name) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name].held);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
  }

  /** The surface's depth alone, a little behind itself so that its own edges stand before it. */
  hide() {
    const { gl } = this;
    gl.uniform2f(this.where.shift, 0, 0);
    gl.colorMask(false, false, false, false);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 2);
    gl.depthFunc(gl.LEQUAL);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.faces.held);
    gl.drawElements(gl.TRIANGLES, this.buffers.faces.count, gl.UNSIGNED_INT, 0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.colorMask(true, true, true, true);
    gl.depthMask(false);
  }

  stroke([red, green, blue, opacity], thick, [width, height], draw) {
    const { gl } = this;
    for (const [x, y] of thick ? THICK : [[0, 0]]) {
      gl.uniform2f(this.where.shift, (2 * x) / width, (2 * y) / height);
      for (const [compare, share] of [[gl.LEQUAL, 1], [gl.GREATER, HIDDEN]]) {
        gl.depthFunc(compare);
        gl.uniform4f(this.where.colour, red, green, blue, opacity * share);
        draw();
      }
    }
  }

  ring({ at, normal, radius, colour }, size) {
    const { gl } = this;
    const up = normalised(normal);
    const right = normalised(cross(up, Math.abs(up[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    const on = cross(up, right);
    const middle = add(add(at, this.centre, -1), up, 0.02 * radius);
    const round = Array.from({ length: RING }, (_, i) => {
      const angle = (2 * Math.PI * i) / RING;
      return add(add(middle, right, radius * Math.cos(angle)), on, radius * Math.sin(angle));
    });
    this.fill("ring", gl.ARRAY_BUFFER, new Float32Array(round.flat()));
    this.places("ring");
    this.stroke(colour, true, size, () => gl.drawArrays(gl.LINE_LOOP, 0, RING));
  }
}
