// Linear reflectance to the sRGB of a colour input, and back (IEC 61966-2-1).

const toSrgb = (value) => (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);
const toLinear = (value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);

/** `#rrggbb` of a linear colour. */
export function toHex(linear) {
  const bytes = linear.map((value) => Math.round(255 * toSrgb(Math.min(1, Math.max(0, value)))));
  return `#${bytes.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}

/** Linear colour of `#rrggbb`, to four digits. */
export function fromHex(hex) {
  return [1, 3, 5].map((at) => Number(toLinear(parseInt(hex.slice(at, at + 2), 16) / 255).toPrecision(4)));
}
