// Elements, made of text alone: nothing that comes from a link or from rulec is read as HTML.

/** An element with attributes (those that begin with "on" listen) and children. */
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
