// The canvases that fill the window (A, B for comparison, a still over A) and the size asked of the server.

const SOFTWARE_WIDTH = 1280;
const STILL = 2;
const MARKS = ["data-drawn", "data-beside", "data-still"];

/** Draws bitmaps; stream 0 on A, stream 1 on B. `size` events tell when another size should be asked for. */
export class Screen extends EventTarget {
  constructor(root) {
    super();
    this.root = root;
    this.canvases = ["#picture", "#picture-b", "#picture-still"].map((name) => root.querySelector(name));
    this.contexts = this.canvases.map((canvas) => canvas.getContext("2d", { alpha: false }));
    this.limits = { width: SOFTWARE_WIDTH, height: SOFTWARE_WIDTH };
    this.drawn = [];
    this.width = 0;
    this.height = 0;
    this.measure();
    new ResizeObserver(() => this.measure()).observe(root);
  }

  /** Largest picture, in device pixels; `software` renderers are spared more than they can draw. */
  limit(width, height, software) {
    this.limits = { width: Math.min(width, software ? SOFTWARE_WIDTH : width), height };
    this.measure();
  }

  measure() {
    const box = this.root.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    const scale = Math.min(ratio, this.limits.width / Math.max(1, box.width), this.limits.height / Math.max(1, box.height));
    const width = Math.max(16, Math.round(box.width * scale));
    const height = Math.max(16, Math.round(box.height * scale));
    if (width === this.width && height === this.height) return;
    this.width = width;
    this.height = height;
    this.dispatchEvent(new Event("size"));
  }

  /** Copy a picture into its canvas, which takes the picture's size: the compositor stretches it at no cost of ours. */
  draw(stream, bitmap) {
    const canvas = this.canvases[stream];
    const { displayWidth: width = bitmap.width, displayHeight: height = bitmap.height } = bitmap;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    this.contexts[stream].drawImage(bitmap, 0, 0);
    if (this.drawn[stream]) return;
    this.drawn[stream] = true;
    this.root.setAttribute(MARKS[stream], "");
  }

  /** Lay images that are no frames over A and B, as a reference and the picture it was compared with. */
  still(picture, beside) {
    this.draw(STILL, picture);
    this.draw(1, beside);
  }

  /** B has nothing to show until its next picture. */
  forget() {
    this.drawn[1] = false;
    this.root.removeAttribute(MARKS[1]);
  }

  /** Grey the picture while the connection is away. */
  grey(on) {
    this.root.classList.toggle("away", on);
  }
}
