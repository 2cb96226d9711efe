// The page: handles input, choices and questions, and shows the answers.

import { comparison, examples, messages, rules, trouble, verdicts } from "./answers.js";
import { Asker } from "./asker.js";
import { byId, counted, element } from "./dom.js";
import { Editor, colouring } from "./editor.js";
import { Files, nameOf } from "./files.js";
import { packed, unpacked } from "./link.js";

const PAUSE_MS = 250;
const PATIENCE_MS = 1500;
const OWN = "this rulebook";
const TABS = ["test", "judge", "compare", "rules"];
const DOING = {
  check: "Reading the rulebook",
  format: "Tidying",
  source: "Fetching a rulebook",
  test: "Running the examples",
  judge: "Judging the traces",
  compare: "Comparing",
  rules: "Writing it in English",
};

let patience;
let pause;
let tab = "test";
let isSound;
let asked = {};
let written = "";
const editor = new Editor(byId("source"), byId("shown"), edited);
const files = new Files(byId("files"), byId("remove"), editor, filesChanged);
const compiled = {};
const traces = byId("traces");
const asker = new Asker(stateChanged);

function stateChanged(state, about) {
  clearTimeout(patience);
  byId("stop").hidden = true;
  if (state === "starting") say("Python is starting (about 16 MB the first time)");
  else if (state === "ready") say("Ready");
  else if (state === "broken") say(`Python does not start: ${about}`);
  else {
    // Quick answers need no announcement.
    patience = setTimeout(() => {
      say(`${DOING[about.ask]} …`);
      byId("stop").hidden = false;
    }, PATIENCE_MS);
  }
}

function say(text) {
  if (byId("state").textContent !== text) byId("state").textContent = text;
}

// Editing: the check runs first, the other questions after it if there is no error.

function edited() {
  clearTimeout(pause);
  pause = setTimeout(look, PAUSE_MS);
}

async function look() {
  files.keep();
  void keepLink();
  const source = editor.text;
  const answer = await asker.ask({ ask: "check", source, others: files.others() });
  if (!answer || source !== editor.text) return;
  const findings = answer.result ?? answer.findings ?? [];
  for (const one of findings) {
    one.isOwn = isOwn(one.place ?? {}) && one.place.line !== null;
    one.isShown = one.place?.file === nameOf(source);
  }
  editor.mark(findings.filter((one) => one.isOwn && one.isShown));
  const errors = findings.filter((one) => one.severity === "error").length;
  const warnings = findings.length - errors;
  isSound = errors === 0 && !answer.failure;
  const counts = [errors && counted(errors, "error"), warnings && counted(warnings, "warning")];
  byId("count").textContent = counts.filter(Boolean).join(", ") || "nothing found";
  byId("found").replaceChildren(
    ...(answer.failure ? [trouble(answer)] : messages(findings, (place) => files.show(place), mend)),
  );
  if (isSound) askTab();
  else outdated();
}

function mend(fix) {
  editor.replace(...exactly(fix.place), fix.text);
}

/** The text at a place; empty for an insertion. */
function exactly(place) {
  const [from, to] = editor.range(place);
  const isEmpty = place.line === place.end_line && place.column === place.end_column;
  return isEmpty ? [from, from] : [from, to];
}

function outdated() {
  const panel = byId(tab);
  if (tab === "compare") return;
  panel.querySelector(".summary").textContent =
    isSound === false ? "Waiting for a rulebook without errors." : "…";
  panel.querySelector(".result").replaceChildren();
  delete asked[tab];
}

// The four questions.

const QUESTIONS = {
  test: () => files.rulebook(),
  rules: () => files.rulebook(),
  judge: () => ({ ...files.rulebook(), book: value("judge-book"), traces: traces.value, compiled }),
};

const value = (id) => (byId(id).value === OWN ? "" : byId(id).value);

function askTab() {
  if (!(tab in QUESTIONS)) return;
  const question = { ask: tab, ...QUESTIONS[tab]() };
  const key = JSON.stringify(question);
  if (asked[tab] === key) return;
  if (tab === "judge" && !traces.value.trim()) {
    put(tab, "No trace yet.", []);
    return;
  }
  asked[tab] = key;
  void answered(tab, question, key);
}

async function answered(kind, question, key) {
  const answer = await asker.ask(question);
  if (asked[kind] !== key) return;
  if (!answer) {
    put(kind, "Stopped.", []);
    delete asked[kind];
    return;
  }
  if (!("result" in answer)) put(kind, "There is no answer.", [trouble(answer)]);
  else put(kind, ...ANSWERS[kind](answer.result));
}

const isOwn = (place) => files.has(place.file);

const ANSWERS = {
  test: (run) => [
    `${counted(run.examples.length, "example")}: ${run.passed} passed, ${run.failed} failed`,
    examples(run, isOwn, (place) => files.show(place), insertion),
  ],
  rules: (document) => [counted(document.rules.length, "rule"), rules(document)],
  judge: (judged) => {
    const n = (satisfied) => judged.filter((one) => one.satisfied === satisfied).length;
    const wrong = judged.filter((one) => one.findings).length;
    const rest = [n(null) && `, ${n(null)} open`, wrong && `, ${wrong} not judged`].filter(Boolean).join("");
    return [`${counted(judged.length, "trace")}: ${n(true)} satisfied, ${n(false)} violated${rest}`, verdicts(judged)];
  },
  compare: (diff) => {
    const n = (relation) => diff.rules.filter((pair) => pair.relation === relation).length;
    const parts = ["stricter", "laxer", "incomparable", "equal", "undecided"].filter(n);
    const days = `${diff.first.name} is the law of ${diff.first.at}, ${diff.second.name} that of ${diff.second.at}.`;
    const said = parts.map((relation) => `${n(relation)} ${relation}`).join(", ");
    return [`${counted(diff.rules.length, "shared rule")}${said ? `: ${said}` : ""}. ${days}`, comparison(diff, tried)];
  },
};

function put(kind, summary, nodes) {
  const panel = byId(kind);
  panel.querySelector(".summary").textContent = summary;
  panel.querySelector(".result").replaceChildren(...nodes.filter(Boolean));
}

/** A button that writes a missing example into its rule. */
function insertion(rule, example) {
  const { source } = files.rulebook();
  const head = new RegExp(`\\brule\\s+${rule}\\b`).exec(source);
  const end = head ? source.indexOf("\n}", head.index) : -1;
  if (end < 0) return null;
  const insert = () => {
    files.show({ file: nameOf(source) });
    editor.replace(end, end, `\n  ${example}`);
  };
  return element("button", { type: "button", onclick: insert }, "Insert it");
}

/** Judge a trace that a comparison has found. */
function tried(trace) {
  traces.value = JSON.stringify(trace);
  show("judge");
  byId("tab-judge").focus();
  void keepLink();
}

function compare(event) {
  event.preventDefault();
  files.keep();
  const question = { ask: "compare", ...files.rulebook(), first: value("first"), second: value("second"), rule: byId("rule").value.trim() };
  const key = JSON.stringify(question);
  asked.compare = key;
  put("compare", "Comparing …", []);
  void keepLink();
  void answered("compare", question, key);
}

// Tabs: arrow keys move between them, as usual.

function show(kind) {
  tab = kind;
  for (const name of TABS) {
    const isChosen = name === kind;
    byId(name).hidden = !isChosen;
    byId(`tab-${name}`).setAttribute("aria-selected", isChosen);
    byId(`tab-${name}`).tabIndex = isChosen ? 0 : -1;
  }
  if (isSound) askTab();
  else outdated();
}

function listen() {
  for (const name of TABS) {
    byId(`tab-${name}`).addEventListener("click", () => {
      show(name);
      void keepLink();
    });
    byId(`tab-${name}`).addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      const next = { Home: 0, End: TABS.length - 1 }[event.key] ?? TABS.indexOf(name) + step;
      if (Number.isNaN(next)) return;
      event.preventDefault();
      show(TABS.at(next % TABS.length));
      byId(`tab-${tab}`).focus();
      void keepLink();
    });
  }
  traces.addEventListener("input", edited);
  byId("judge-book").addEventListener("change", edited);
  byId("comparison").addEventListener("submit", compare);
  byId("stop").addEventListener("click", () => asker.stop());
  byId("tidy").addEventListener("click", tidy);
  byId("share").addEventListener("click", share);
  byId("start").addEventListener("change", started);
  byId("add").addEventListener("click", () => files.add());
  byId("remove").addEventListener("click", () => files.remove());
  byId("open").addEventListener("change", opened);
  window.addEventListener("hashchange", () => void fromLink());
}

async function tidy() {
  const source = editor.text;
  const answer = await asker.ask({ ask: "format", source });
  if (source !== editor.text) return;
  if (answer?.result === undefined) say("It cannot be tidied while there are errors in it");
  else if (answer.result === source) say("It is tidy");
  else editor.replace(0, source.length, answer.result);
}

// Files: one of several is shown.

function filesChanged() {
  listBooks();
  clearTimeout(pause);
  void look();
}

/** Files from the user's disk: sources, compiled rulebooks, traces. */
async function opened() {
  const input = byId("open");
  for (const file of input.files) {
    const text = await file.text();
    if (file.name.endsWith(".rules")) files.add(text);
    else if (file.name.endsWith(".json")) {
      compiled[file.name] = text;
      listBooks();
      byId("judge-book").value = file.name;
      show("judge");
    } else {
      traces.value = text;
      show("judge");
    }
  }
  input.value = "";
  edited();
}

/** The rulebooks that a question can be about: those on the page, and the shipped ones. */
function listBooks() {
  const named = (name) => element("option", { value: name }, name);
  for (const id of ["judge-book", "first", "second"]) {
    const before = byId(id).value;
    const here = [...files.otherBooks(), ...(id === "judge-book" ? Object.keys(compiled) : [])];
    byId(id).replaceChildren(element("option", { value: OWN }, OWN), ...here.map(named), ...options(rulebooks));
    byId(id).value = before;
    if (!byId(id).value) byId(id).value = OWN;
  }
}

// Links: the address always contains the page's contents, except opened compiled rulebooks.

async function keepLink() {
  const content = { source: editor.text, others: JSON.stringify(files.others()), traces: traces.value, tab };
  for (const id of ["judge-book", "first", "second", "rule"]) content[id] = byId(id).value;
  written = `#${await packed(content)}`;
  history.replaceState(null, "", written);
}

async function fromLink() {
  if (location.hash.length < 2 || location.hash === written) return false;
  try {
    fill(await unpacked(location.hash.slice(1)));
    return true;
  } catch (error) {
    say(`The link cannot be read: ${error.message}`);
    return false;
  }
}

function fill(content) {
  files.fill(content.source ?? "", content.others);
  listBooks();
  traces.value = content.traces ?? "";
  for (const id of ["judge-book", "first", "second"]) {
    const has = [...byId(id).options].some((option) => option.value === content[id]);
    if (has) byId(id).value = content[id];
  }
  byId("rule").value = content.rule ?? "";
  asked = {};
  isSound = undefined;
  show(TABS.includes(content.tab) ? content.tab : "test");
  void look();
}

async function share() {
  await keepLink();
  try {
    await navigator.clipboard.writeText(location.href);
    say("The link is copied");
  } catch {
    say("The link is in the address bar");
  }
}

async function started() {
  const chosen = byId("start").value;
  const sample = samples.find((one) => one.title === chosen);
  if (sample) {
    fill({ ...sample, tab, "judge-book": OWN, first: OWN, second: sample.against });
    return;
  }
  const answer = await asker.ask({ ask: "source", name: chosen });
  if (answer?.result !== undefined && byId("start").value === chosen) {
    fill({ source: answer.result, traces: traces.value, tab });
  }
}

// At the start

const fetched = async (name) => (await fetch(name)).json();
const [words, { samples, rulebooks }] = await Promise.all([fetched("words.json"), fetched("samples.json")]);
editor.spansOf = colouring(words);

const options = (listed) => listed.map(({ name, title }) => element("option", { value: name }, title === name ? name : `${name}: ${title}`));
byId("start").append(
  element("optgroup", { label: "Samples" }, samples.map(({ title }) => element("option", { value: title }, title))),
  element("optgroup", { label: "Shipped rulebooks" }, options(rulebooks)),
);
listBooks();
listen();
if (!(await fromLink())) {
  byId("start").value = samples[0].title;
  await started();
}
