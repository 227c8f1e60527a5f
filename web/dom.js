// Small helpers to make elements; every module that shows something uses them.

const SVG = "http://www.w3.org/2000/svg";

function apply(node, properties) {
  for (const [name, value] of Object.entries(properties ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name === "on") {
      for (const [event, handler] of Object.entries(value)) node.addEventListener(event, handler);
    } else if (name === "text") node.textContent = value;
    else if (name === "value") node.value = value;
    else if (name === "class") node.setAttribute("class", value);
    else if (name === "data") Object.assign(node.dataset, value);
    else if (name === "style") Object.assign(node.style, value);
    else node.setAttribute(name, value === true ? "" : value);
  }
}

/** An HTML element with properties (`on`, `text`, `class`, `data`, `style`, or any attribute) and children. */
export function el(tag, properties, ...children) {
  const node = document.createElement(tag);
  apply(node, properties);
  node.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

/** The same for SVG. */
export function svg(tag, properties, ...children) {
  const node = document.createElementNS(SVG, tag);
  apply(node, properties);
  node.append(...children.flat());
  return node;
}

/** A line icon of `icons.svg`, hidden from screen readers: its button carries the words. */
export function icon(name) {
  return svg("svg", { class: "icon", "aria-hidden": "true" }, svg("use", { href: `icons.svg#${name}` }));
}

/** A button of one icon; `label` is read aloud and shown as its tooltip. */
export function iconButton(name, label, handler, properties = {}) {
  return el("button", { type: "button", class: "icon-button", "aria-label": label, title: label, on: { click: handler }, ...properties }, icon(name));
}

/** Rows of `[name, value]` as the terms and descriptions of a `dl`. */
export function terms(rows) {
  return rows.flatMap(([name, value]) => [el("dt", { text: name }), el("dd", { text: value })]);
}

/** A bar of colours, and under it what its ends and its middle stand for. */
export function scaleBar(colours, words) {
  const bar = el("span", { class: "scale-bar", style: { background: `linear-gradient(90deg, ${colours})` } });
  return [bar, el("span", { class: "scale-ends" }, words.map((text) => el("span", { text })))];
}

/** A row of choices, `[value, text]` each, of which one holds: the group and its radio buttons. */
export function segments(label, choices, choose) {
  const name = freshId("choice");
  const radios = choices.map(([value]) => el("input", { type: "radio", name, value, on: { change: () => choose(value) } }));
  const labels = choices.map(([, text], i) => el("label", { class: "segment" }, radios[i], el("span", { text })));
  return { radios, group: el("div", { class: "segments", role: "radiogroup", "aria-label": label }, labels) };
}

/** `double_horizon_map` as people read it. */
export function humanise(name) {
  const words = String(name).replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** The number in a text as people write it, or NaN. */
export function numberIn(text) {
  return Number(text.trim().replace(",", ".").replace("−", "-") || NaN);
}

let counter = 0;

/** An id no other element of the page has. */
export function freshId(stem) {
  counter += 1;
  return `${stem}-${counter}`;
}

/** Run `work` at most once per animation frame, with the latest call's arguments. */
export function perFrame(work) {
  let latest = null;
  return (...values) => {
    if (latest === null) requestAnimationFrame(() => {
      const now = latest;
      latest = null;
      work(...now);
    });
    latest = values;
  };
}

/** Follow a pointer that went down on `node` until it is let go. */
export function follow(node, event, move, end) {
  node.setPointerCapture(event.pointerId);
  node.addEventListener("pointermove", move);
  node.addEventListener("lostpointercapture", () => {
    node.removeEventListener("pointermove", move);
    end?.();
  }, { once: true });
}

/** Write a text where it differs: even the same text written again costs the page a layout. */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}
