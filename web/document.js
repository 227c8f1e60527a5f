// The state document: paths into it, merge patches, differences. Pure functions, no page.

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

/** The value at a dotted path, or undefined. */
export function valueAt(document, path) {
  return path.split(".").reduce((here, key) => (isObject(here) || Array.isArray(here) ? here[key] : undefined), document);
}

/** The merge patch that sets one path. */
export function patchOf(path, value) {
  return path.split(".").reduceRight((inner, key) => ({ [key]: inner }), value);
}

/** Apply a merge patch; a changed `kind` starts that union afresh, as the server does. */
export function merge(document, patch) {
  const result = { ...document };
  for (const [key, value] of Object.entries(patch)) {
    const old = result[key];
    const same = isObject(value) && isObject(old) && (value.kind ?? old.kind) === old.kind;
    result[key] = same ? merge(old, value) : value;
  }
  return result;
}

/** One patch with the effect of `first` and then `second`. */
export function combine(first, second) {
  const result = { ...first };
  for (const [key, value] of Object.entries(second)) {
    const old = result[key];
    const inside = isObject(value) && isObject(old) && value.kind === undefined;
    result[key] = inside ? combine(old, value) : value;
  }
  return result;
}

/** A list with one of its items changed by a merge patch; another `kind` starts it afresh. */
export function withItem(list, index, patch) {
  const old = list[index];
  return list.with(index, (patch.kind ?? old.kind) === old.kind ? merge(old, patch) : patch);
}

/** True when two JSON values are equal. */
export function same(a, b) {
  if (a === b) return true;
  if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((item, i) => same(item, b[i]));
  if (!isObject(a) || !isObject(b)) return false;
  const keys = new Set([...Object.keys(a), ...Object.keys(b)]);
  return [...keys].every((key) => same(a[key], b[key]));
}

/** `[path, value]` of every leaf where `document` differs from `base`, a changed `kind` before its fields. */
export function differences(document, base, prefix = "") {
  const found = [];
  const fresh = isObject(base) && document.kind === base.kind ? base : {};
  const keys = Object.keys(document).sort((a, b) => (b === "kind") - (a === "kind"));
  for (const key of keys) {
    const [value, old] = [document[key], fresh[key]];
    if (same(value, old)) continue;
    if (isObject(value)) found.push(...differences(value, old ?? {}, `${prefix}${key}.`));
    else found.push([`${prefix}${key}`, value]);
  }
  return found;
}
