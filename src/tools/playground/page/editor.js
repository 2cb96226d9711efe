// A text area, and beneath it the same text with colours and underlined errors.

import { element } from "./dom.js";

const CLASSES = [
  [/^comment/, "comment"],
  [/^string/, "text"],
  [/^constant\.language/, "word"],
  [/^constant|unit/, "number"],
  [/^entity/, "name"],
  [/^storage/, "head"],
  [/^keyword/, "word"],
];

const classOf = (scope) => CLASSES.find(([pattern]) => pattern.test(scope))?.[1];

/** A function that colours a text by the TextMate grammar for editors. */
export function colouring(grammar) {
  const patterns = grammar.patterns.map(({ name, match, captures }) => ({
    match: new RegExp(match, "dmuy"),
    whole: name && classOf(name),
    parts: Object.entries(captures ?? {}).map(([n, part]) => [Number(n), classOf(part.name)]),
  }));
  return function spansOf(text) {
    const spans = [];
    let at = 0;
    while (at < text.length) {
      let found = null;
      for (const pattern of patterns) {
        pattern.match.lastIndex = at;
        found = pattern.match.exec(text);
        if (!found?.[0]) continue;
        if (pattern.whole) spans.push([at, at + found[0].length, pattern.whole]);
        for (const [n, kind] of pattern.parts) if (found[n]) spans.push([...found.indices[n], kind]);
        at += found[0].length;
        break;
      }
      if (!found?.[0]) at += WORD.exec(text.slice(at, at + 200))[0].length;
    }
    return spans;
  };
}

const WORD = /^(?:[\p{L}_][\p{L}\p{N}_]*|\s+|.)/su;

/** The text with its colours and underlines, as nodes. */
function painted(text, spans, marks) {
  const cuts = new Set([0, text.length]);
  for (const [from, to] of [...spans, ...marks]) cuts.add(from).add(to);
  const places = [...cuts].filter((n) => n <= text.length).sort((a, b) => a - b);
  let next = 0;
  return places.slice(0, -1).map((from, n) => {
    const piece = text.slice(from, places[n + 1]);
    while (next < spans.length && spans[next][1] <= from) next += 1;
    const colour = spans[next]?.[0] <= from ? spans[next][2] : undefined;
    const mark = marks.find(([start, end]) => start <= from && from < end)?.[2];
    const kinds = [colour, mark].filter(Boolean).join(" ");
    return kinds ? element("span", { class: kinds }, piece) : piece;
  });
}

/** The offsets at which the lines of a text begin. */
function starts(text) {
  const found = [0];
  for (let n = text.indexOf("\n"); n >= 0; n = text.indexOf("\n", n + 1)) found.push(n + 1);
  return found;
}

/** The offset of a place; rulec counts lines and code points from 1, JavaScript UTF-16 units. */
function offset(text, lines, line, column) {
  const start = lines[Math.min(line, lines.length) - 1];
  const end = lines[line] ?? text.length + 1;
  return start + [...text.slice(start, end - 1)].slice(0, column - 1).join("").length;
}

export class Editor {
  constructor(area, shown, onEdit) {
    this.area = area;
    this.shown = shown;
    this.marks = [];
    this.spansOf = () => [];
    area.addEventListener("input", () => {
      this.marks = [];
      this.paint();
      onEdit();
    });
    area.addEventListener("scroll", () => this.scroll());
  }

  get text() {
    return this.area.value;
  }

  set text(text) {
    this.area.value = text;
    this.marks = [];
    this.paint();
  }

  /** The start and end offsets of a finding's place. */
  range(place) {
    const lines = starts(this.text);
    const from = offset(this.text, lines, place.line ?? 1, place.column ?? 1);
    const to = offset(this.text, lines, place.end_line ?? place.line ?? 1, place.end_column ?? 1);
    return [from, Math.max(to, from + 1)];
  }

  mark(findings) {
    this.marks = findings.map(({ place, severity }) => [...this.range(place), severity]);
    this.area.setAttribute("aria-invalid", findings.some((one) => one.severity === "error"));
    this.paint();
  }

  /** Select a place and scroll it into view. */
  show(place) {
    const [from, to] = this.range(place);
    this.area.focus();
    this.area.setSelectionRange(from, to);
    const line = this.text.slice(0, from).split("\n").length - 1;
    const height = parseFloat(getComputedStyle(this.area).lineHeight);
    this.area.scrollTop = Math.max(0, line * height - this.area.clientHeight / 3);
  }

  /** Replace a text so that it can be undone. */
  replace(from, to, text) {
    this.area.focus();
    this.area.setSelectionRange(from, to);
    // No other way of editing is part of the browser's undo history.
    if (!document.execCommand("insertText", false, text)) {
      this.area.setRangeText(text);
      this.area.dispatchEvent(new Event("input"));
    }
  }

  paint() {
    this.shown.replaceChildren(...painted(this.text, this.spansOf(this.text), this.marks), "\n");
    this.scroll();
  }

  scroll() {
    this.shown.scrollTop = this.area.scrollTop;
    this.shown.scrollLeft = this.area.scrollLeft;
  }
}
