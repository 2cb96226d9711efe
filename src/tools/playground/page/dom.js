// Builds elements from text only: nothing from a link or from rulec is parsed as HTML.

/** An element with attributes (those that begin with "on" are event listeners) and children. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== undefined && child !== null));
  return made;
}

export const byId = (id) => document.getElementById(id);

/** "1 trace", "2 traces" */
export const counted = (n, noun) => `${n} ${noun}${n === 1 ? "" : "s"}`;

const unfolded = new Set();

/**
 * The first of many nodes, and the rest behind "and 12 more …", each part wrapped by `wrap`.
 *
 * A list stays expanded when it is rebuilt: lists are identified by `key`.
 */
export function folded(nodes, most, key, noun, wrap = (part) => part) {
  if (!nodes.length) return [];
  // One or two more entries take hardly more room than the line that would hide them.
  if (nodes.length <= most + 2) return [wrap(nodes)].flat();
  const rest = element(
    "details",
    {
      class: "rest",
      open: unfolded.has(key),
      ontoggle: () => (rest.open ? unfolded.add(key) : unfolded.delete(key)),
    },
    element("summary", {}, `and ${nodes.length - most} more ${noun}`),
    wrap(nodes.slice(most)),
  );
  return [wrap(nodes.slice(0, most)), rest].flat();
}
