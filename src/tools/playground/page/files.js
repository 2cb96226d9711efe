// Several rulebooks and vocabularies side by side, of which the editor shows one.

import { element } from "./dom.js";

const NEW = (name) => `vocabulary ${name} {\n  signal fog default false\n}\n`;

/** What a file is called: as the rulebook or the vocabulary in it is. */
export const nameOf = (text) => `${/^\s*(?:rulebook|vocabulary)\s+([\w-]+)/m.exec(text)?.[1] ?? "rulebook"}.rules`;

const isVocabulary = (text) => /^\s*vocabulary\b/m.test(text) && !/^\s*rulebook\b/m.test(text);

export class Files {
  /** `onChange` is told of another file that is shown, of a new one and of one that is gone. */
  constructor(list, removal, editor, onChange) {
    Object.assign(this, { list, removal, editor, onChange, texts: [""], at: 0 });
  }

  /** Take what the editor has. */
  keep() {
    const before = nameOf(this.texts[this.at]);
    this.texts[this.at] = this.editor.text;
    if (nameOf(this.editor.text) !== before) this.paint();
  }

  /** All but the one that is shown. */
  others() {
    return this.texts.filter((_, n) => n !== this.at);
  }

  has(name) {
    return this.texts.some((text) => nameOf(text) === name);
  }

  /** What questions are about: the rulebook that is shown, or beside a vocabulary the first one. */
  rulebook() {
    const first = this.texts.findIndex((text) => !isVocabulary(text));
    const at = isVocabulary(this.texts[this.at]) && first >= 0 ? first : this.at;
    return { source: this.texts[at], others: this.texts.filter((_, n) => n !== at) };
  }

  /** The names of the rulebooks beside that one. */
  otherBooks() {
    return this.rulebook().others.filter((text) => !isVocabulary(text)).map(nameOf);
  }

  /** Begin with one text that is shown, and others beside it. */
  fill(text, others = "[]") {
    const listed = JSON.parse(others);
    const beside = Array.isArray(listed) ? listed.filter((one) => typeof one === "string") : [];
    this.texts = [...beside, text];
    this.at = beside.length;
    this.editor.text = text;
    this.paint();
  }

  /** Show another file, one more or one in place of the one of its name. */
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

  /** Show a place, in whatever file it is. */
  show(place) {
    this.keep();
    // Of two of the same name the one that is shown counts, as in questions.
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
