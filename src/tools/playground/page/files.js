// Several rulebooks and vocabularies; the editor shows one of them.

import { element } from "./dom.js";

const NEW = (name) => `vocabulary ${name} {\n  signal fog default false\n}\n`;

/** The name of a file: that of the rulebook or vocabulary in it. */
export const nameOf = (text) => `${/^\s*(?:rulebook|vocabulary)\s+([\w-]+)/m.exec(text)?.[1] ?? "rulebook"}.rules`;

const isVocabulary = (text) => /^\s*vocabulary\b/m.test(text) && !/^\s*rulebook\b/m.test(text);

export class Files {
  /** `onChange` is called when another file is shown, or a file is added or removed. */
  constructor(list, removal, editor, onChange) {
    Object.assign(this, { list, removal, editor, onChange, texts: [""], at: 0 });
  }

  /** Store the editor's text. */
  keep() {
    const before = nameOf(this.texts[this.at]);
    this.texts[this.at] = this.editor.text;
    if (nameOf(this.editor.text) !== before) this.paint();
  }

  /** All files except the one that is shown. */
  others() {
    return this.texts.filter((_, n) => n !== this.at);
  }

  has(name) {
    return this.texts.some((text) => nameOf(text) === name);
  }

  /** The subject of questions: the rulebook that is shown, or the first one if a vocabulary is. */
  rulebook() {
    const first = this.texts.findIndex((text) => !isVocabulary(text));
    const at = isVocabulary(this.texts[this.at]) && first >= 0 ? first : this.at;
    return { source: this.texts[at], others: this.texts.filter((_, n) => n !== at) };
  }

  /** The names of the other rulebooks. */
  otherBooks() {
    return this.rulebook().others.filter((text) => !isVocabulary(text)).map(nameOf);
  }

  /** Start with one text that is shown, and others. */
  fill(text, others = "[]") {
    const listed = JSON.parse(others);
    const beside = Array.isArray(listed) ? listed.filter((one) => typeof one === "string") : [];
    this.texts = [...beside, text];
    this.at = beside.length;
    this.editor.text = text;
    this.paint();
  }

  /** Show a new file, which replaces one with the same name. */
  add(text) {
    this.keep();
    let number = 1;
    while (text === undefined && this.has(`words${number}.rules`)) number += 1;
    const added = text ?? NEW(`words${number}`);
    const same = this.texts.findIndex((one) => nameOf(one) === nameOf(added));
    if (same >= 0) this.texts[same] = added;
    else this.texts.push(added);
    this.choose(same >= 0 ? same : this.texts.length - 1);
  }

  remove() {
    if (this.texts.length === 1) return;
    this.texts.splice(this.at, 1);
    this.choose(Math.min(this.at, this.texts.length - 1));
    this.list.children[this.at].focus();
  }

  choose(at) {
    this.at = at;
    this.editor.text = this.texts[at];
    this.paint();
    this.onChange();
  }

  /** Show a place, whichever file it is in. */
  show(place) {
    this.keep();
    // Of two files with the same name the one that is shown is meant, as in questions.
    const isShown = nameOf(this.texts[this.at]) === place.file;
    const at = this.texts.findIndex((text) => nameOf(text) === place.file);
    if (at >= 0 && !isShown) this.choose(at);
    if (place.line) this.editor.show(place);
  }

  paint() {
    const buttons = this.texts.map((text, n) =>
      element("button", { type: "button", "aria-pressed": String(n === this.at), onclick: () => this.turn(n) }, nameOf(text)),
    );
    this.list.replaceChildren(...buttons);
    this.removal.disabled = this.texts.length === 1;
  }

  turn(at) {
    this.keep();
    this.choose(at);
    this.list.children[at].focus();
  }
}
