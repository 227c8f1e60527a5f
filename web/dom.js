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
    else node.setAttribute(name, value === true ? "" : value);
  }
}

/** An HTML element with properties (`on`, `text`, `class`, `data`, or any attribute) and children. */
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

const ICONS = {
  undo: "M9 7 4.5 11.5 9 16M5 11.5h9a5 5 0 0 1 0 10h-2",
  redo: "m15 7 4.5 4.5L15 16M19 11.5h-9a5 5 0 0 0 0 10h2",
  compare: "M12 3v18M4 7h5v10H4zM15 7h5v10h-5z",
  share: "M10 14a4 4 0 0 0 6 .4l3-3a4 4 0 0 0-5.7-5.7L12 7M14 10a4 4 0 0 0-6-.4l-3 3a4 4 0 0 0 5.7 5.7L12 17",
  export: "M12 3v12M7.5 10.5 12 15l4.5-4.5M4 20h16",
  code: "m8 7-5 5 5 5M16 7l5 5-5 5M13.5 5l-3 14",
  open: "M12 16V4M7.5 8.5 12 4l4.5 4.5M4 20h16",
  help: "M9.2 9a3 3 0 1 1 4.3 2.7c-1 .6-1.5 1.2-1.5 2.3M12 17.5v.2M12 3a9 9 0 1 1 0 18 9 9 0 0 1 0-18z",
  theme: "M12 3a9 9 0 1 0 0 18zM12 3a9 9 0 0 1 0 18",
  panel: "M4 6h10M18 6h2M4 12h3M11 12h9M4 18h9M17 18h3M16 4v4M9 10v4M15 16v4",
  play: "M8 5.5v13l11-6.5z",
  pause: "M8 5.5v13M16 5.5v13",
  close: "M6 6l12 12M18 6 6 18",
  reset: "M5 5v5h5M5.6 10A7.5 7.5 0 1 1 4.6 14",
  place: "M12 21c4.5-4.7 7-8.2 7-11a7 7 0 1 0-14 0c0 2.8 2.5 6.3 7 11zM12 12.5a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5z",
  down: "m6 9 6 6 6-6",
  copy: "M9 9h11v11H9zM5 15H4V4h11v1",
  sun: "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM12 2.5v2M12 19.5v2M2.5 12h2M19.5 12h2M5.3 5.3l1.4 1.4M17.3 17.3l1.4 1.4M5.3 18.7l1.4-1.4M17.3 6.7l1.4-1.4",
};

/** An inline line icon, hidden from screen readers: its button carries the words. */
export function icon(name) {
  const shape = svg("path", { d: ICONS[name] });
  return svg("svg", { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true", focusable: "false" }, shape);
}

/** A button of one icon; `label` is read aloud and shown as its tooltip. */
export function iconButton(name, label, handler, properties = {}) {
  return el("button", { type: "button", class: "icon-button", "aria-label": label, title: label, on: { click: handler }, ...properties }, icon(name));
}

/** Rows of `[name, value]` as the terms and descriptions of a `dl`. */
export function terms(rows) {
  return rows.flatMap(([name, value]) => [el("dt", { text: name }), el("dd", { text: value })]);
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
