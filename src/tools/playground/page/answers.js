// Converts rulec's answers to elements.

import { counted, element, folded } from "./dom.js";

// The number of entries shown before a list is expanded.
const MOST_LINES = 10;
const MOST_TOLD = 5;

const plain = (items) => element("ul", { class: "plain" }, items);

const lines = (...texts) => texts.filter(Boolean).map((text) => element("p", {}, text));

/** A finding; `onShow` shows its place, `onFix` fixes it. */
export function finding(one, onShow, onFix) {
  const place = one.place?.line ? `line ${one.place.line}` : "";
  const inSource = one.isOwn && place;
  const file = one.isShown ? "" : one.place?.file;
  const where = inSource
    ? element("button", { type: "button", class: "place", onclick: () => onShow(one.place) }, [file, place].filter(Boolean).join(", "))
    : element("span", { class: "place" }, [one.place?.file?.split("/").at(-1), place].filter(Boolean).join(", "));
  const fix =
    one.fix && one.isShown
      ? element("button", { type: "button", onclick: () => onFix(one.fix) }, one.fix.text ? `Write ${quoted(one.fix.text)}` : "Remove it")
      : null;
  return element(
    "li",
    { class: one.severity },
    element("p", {}, where, " ", element("b", {}, `${one.severity} ${one.code}`), ": ", ...said(one.message)),
    ...one.labels.map((label) => element("p", {}, label.place?.line ? `line ${label.place.line}: ` : "", ...said(label.message))),
    ...one.notes.map((note) => element("p", {}, ...said(note))),
    one.help ? element("p", { class: "help" }, "Help: ", ...said(one.help), " ", fix) : fix,
  );
}

const quoted = (text) => (text.trim().length > 40 ? `“${text.trim().slice(0, 40)}…”` : `“${text.trim()}”`);

/** A message, in which rulec puts source text between backticks. */
const said = (text) =>
  text.split("`").map((part, n) => (n % 2 ? element("code", {}, part) : part));

/** The items of the list of findings below the editor. */
export function messages(found, onShow, onFix) {
  const items = found.map((one) => finding(one, onShow, onFix));
  const rest = (part) => element("ol", { class: "findings" }, part);
  const [first, more] = folded(items, MOST_LINES, "messages", "messages", rest);
  return [...(first?.children ?? []), ...(more ? [element("li", { class: "more" }, more)] : [])];
}

/** The problem with a question: findings, or an internal failure. */
export function trouble(answer) {
  if (answer.findings) return element("ul", { class: "findings" }, answer.findings.map((one) => finding(one)));
  return element("p", { class: "error" }, `rulec failed, which is a bug in rulec: ${answer.failure}`);
}

/** The examples, those of the rulebook's own rules first, and the missing ones. */
export function examples(run, isOwn, onShow, onInsert) {
  const passes = run.examples.map((one) => {
    const name = `${one.rule}/${one.label || one.number}`;
    const text = one.passed ? "pass" : "fail";
    const why = one.passed ? "" : `: it says ${one.says}, but the rule would ${one.does}`;
    const own = one.place && isOwn(one.place);
    return [
      own,
      element(
        "li",
        { class: text },
        element("b", {}, text),
        " ",
        own ? element("button", { type: "button", class: "place", onclick: () => onShow(one.place) }, name) : name,
        why,
      ),
    ];
  });
  const owned = passes.filter(([own]) => own).map(([, item]) => item);
  const others = passes.filter(([own]) => !own).map(([, item]) => item);
  const names = new Set(run.examples.filter((one) => one.place && isOwn(one.place)).map((one) => one.rule));
  const missing = run.coverage.rules.filter((rule) => names.has(rule.rule)).flatMap((rule) =>
    [...new Set([...rule.missing_edges, ...rule.missing_limits].map((one) => one.example))].map((example) =>
      element("li", {}, `No example of ${rule.rule} has this: `, element("code", {}, example), " ", onInsert(rule.rule, example)),
    ),
  );
  const isFailing = (item) => item.className === "fail";
  const passed = owned.filter((item) => !isFailing(item));
  return [
    ...folded([...owned, ...others].filter(isFailing), 2 * MOST_LINES, "failed", "that fail", plain),
    ...folded(passed, MOST_LINES, "passed", "that pass", plain),
    missing.length ? element("h3", {}, `Not covered by any example: ${missing.length}`) : null,
    ...folded(missing, MOST_LINES, "missing", "that no example covers", plain),
    others.length
      ? element(
          "details",
          {},
          element("summary", {}, `${counted(others.length, "example")} that the rulebook inherits`),
          plain(others.filter((item) => !isFailing(item))),
        )
      : null,
  ];
}

/** The rules in plain language, those of the rulebook itself first. */
export function rules({ rules: listed, rulebook }) {
  const articles = listed
    .toSorted((a, b) => (b.book === rulebook) - (a.book === rulebook))
    .map((rule) =>
      element(
        "article",
        {},
        element("h3", {}, `${rule.name} `, element("small", {}, [rule.strength, rule.cite, rule.book === rulebook ? "" : `from ${rule.book}`].filter(Boolean).join(" · "))),
        ...lines(rule.sentence, ...rule.restrictions, ...rule.definitions),
        rule.says ? element("p", { class: "says" }, rule.says) : null,
      ),
    );
  return folded(articles, 4 * MOST_LINES, "rules", "rules");
}

/** The answer for each trace. */
export const verdicts = (listed) =>
  folded(listed.map(verdict), 2 * MOST_LINES, "traces", "traces");

/** A verdict on a trace, with the rules that are open and those that cannot be judged. */
function verdict(one) {
  if (one.findings) return trouble(one);
  const kept = one.violations.length ? "satisfied, but for soft rules" : "satisfied";
  const word = { true: kept, false: "violated", null: "open" }[one.satisfied];
  return element(
    "article",
    { class: { true: "kept", false: "lost", null: "undecided" }[one.satisfied] },
    element("h3", {}, `${one.trace}: `, element("b", {}, word)),
    ...folded(one.violations.map(violation), MOST_TOLD, `violated ${one.trace}`, "violations"),
    ...folded(one.open.map(doubt), MOST_TOLD, `open ${one.trace}`, "that are open"),
    ...unjudged(one.not_judged),
  );
}

const doubt = (one) =>
  element("p", { class: "open" }, `${one.strength} rule `, element("b", {}, one.rule), `${about(one.binding)}: ${one.in_words}`);

/** The rules that cannot be judged, by the reason. */
function unjudged(listed) {
  const reasons = new Map();
  for (const { rule, untold, why } of listed) {
    const reason = why || `the trace does not provide ${untold.join(", ")}`;
    reasons.set(reason, [...(reasons.get(reason) ?? []), rule]);
  }
  if (!reasons.size) return [];
  const items = [...reasons].map(([reason, names]) => element("li", {}, `${names.join(", ")}: ${reason}`));
  return [element("details", {}, element("summary", {}, `${counted(listed.length, "rule")} not judged`), plain(items))];
}

const bound = (binding) =>
  Object.entries(binding).map(([variable, object]) => `${variable} = ${object}`).join(", ");

const about = (binding) => (bound(binding) ? ` for ${bound(binding)}` : "");

function violation(one) {
  const told = one.explanation;
  const after = one.step === null ? "violated at the end of the trace" : `cannot be kept any more after state ${one.step}${one.when}`;
  return element(
    "div",
    { class: "violation" },
    element("p", {}, `${one.strength} rule `, element("b", {}, one.rule), told?.cite ? ` [${told.cite}]` : "", `${about(one.binding)}: ${after}`),
    told?.says ? element("p", { class: "says" }, told.says) : null,
    told ? explained(told) : null,
    told?.in_words ? element("p", {}, told.in_words) : null,
    ...(told?.kept_if ?? []).map((text) => element("p", { class: "repair" }, text)),
  );
}

function explained({ states, decisive, facts, parts }) {
  const at = states.indexOf(decisive);
  const rows = [
    ...facts.map(({ reads, unit, ...row }) => ({ ...row, title: `${reads}${unit ? ` in ${unit}` : ""}`, depth: 0 })),
    ...parts.map(({ formula, ...row }) => ({ ...row, title: formula })),
  ];
  return table(
    "State by state; * marks what changed when the rule was lost",
    states.map(String),
    rows.map(({ title, depth, values, margins, changed }, n) => ({
      title,
      depth,
      begins: n === facts.length,
      // A truth value is followed by its margin.
      cells: values.map((value, place) => {
        const mark = changed && place === at && n < facts.length ? "*" : "";
        return [shown(value), margins[place]].filter(Boolean).join(" ") + mark;
      }),
    })),
    at,
  );
}

function shown(value) {
  if (value === null) return "?";
  if (typeof value === "boolean") return value ? "T" : "F";
  if (typeof value === "object") return `${value.from} to ${value.to}`;
  return String(value);
}

function table(caption, heads, rows, at) {
  const cell = (text, place) => element("td", { class: place === at ? "decisive" : undefined }, text);
  return element(
    "div",
    { class: "wide", tabindex: "0", role: "group", "aria-label": caption },
    element(
      "table",
      {},
      element("caption", {}, caption),
      element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "state"), heads.map((text) => element("th", { scope: "col" }, text)))),
      element(
        "tbody",
        {},
        rows.map(({ title, depth, begins, cells }) =>
          element(
            "tr",
            { class: begins ? "begins" : undefined },
            element("th", { scope: "row", class: `deep-${Math.min(depth, 6)}` }, title),
            cells.map(cell),
          ),
        ),
      ),
    ),
  );
}

const RELATIONS = {
  equal: "the same is forbidden",
  stricter: "{first} is stricter",
  laxer: "{second} is stricter",
  incomparable: "each forbids something that the other allows",
  undecided: "not decided",
};

/** The differences, rule by rule; `onTry` judges a trace that was found. */
export function comparison(diff, onTry) {
  const names = { first: diff.first.name, second: diff.second.name };
  const filled = (text) => text.replace(/\{(\w+)\}/g, (_, name) => names[name]);
  const differing = diff.rules.filter((pair) => pair.relation !== "equal");
  const same = diff.rules.filter((pair) => pair.relation === "equal").map((pair) => pair.rule);
  const traces = (pair) =>
    [
      [pair.first_forbids, names.first, names.second],
      [pair.second_forbids, names.second, names.first],
    ].flatMap(([found, forbids, allows]) =>
      found.map((trace) => [
        element("p", {}, `${forbids} forbids, ${allows} allows: `, element("button", { type: "button", onclick: () => onTry(trace) }, "Judge this trace")),
        states(trace),
      ]),
    );
  const alone = (title, listed) =>
    listed.length ? element("p", {}, `${title}: ${listed.map((one) => one.rule).join(", ")}`) : null;
  const articles = differing.map((pair) =>
    element(
      "article",
      {},
      element("h3", {}, `${pair.rule}: `, element("b", {}, filled(RELATIONS[pair.relation]))),
      element("p", { class: "says" }, `${names.first}: ${[pair.first.cite, pair.first.says].filter(Boolean).join(", ")}`),
      element("p", { class: "says" }, `${names.second}: ${[pair.second.cite, pair.second.says].filter(Boolean).join(", ")}`),
      pair.undecided ? element("p", {}, pair.undecided) : null,
      ...traces(pair).flat(),
    ),
  );
  return [
    ...folded(articles, MOST_LINES, "differing", "that differ"),
    same.length ? element("p", {}, `The same in both: ${same.join(", ")}`) : null,
    alone(`Only in ${names.first}`, diff.only_first),
    alone(`Only in ${names.second}`, diff.only_second),
    diff.settings.length
      ? element("p", {}, `Different settings: ${diff.settings.map((one) => `${one.name} (${one.first} in ${names.first}, ${one.second} in ${names.second})`).join(", ")}`)
      : null,
  ];
}

/** A trace as a table of its states' values. */
function states(trace) {
  const rows = new Map();
  trace.states.forEach((state, n) => {
    for (const [name, value] of said_of(state, [])) {
      if (!rows.has(name)) rows.set(name, trace.states.map(() => ""));
      rows.get(name)[n] = shown(value);
    }
  });
  return table(
    `Objects: ${Object.entries(trace.objects).map(([name, type]) => `${name} (${type})`).join(", ") || "none"}; omitted values have their defaults`,
    trace.states.map((_, n) => String(n)),
    [...rows].map(([title, cells]) => ({ title, depth: 0, begins: false, cells })),
    -1,
  );
}

function* said_of(value, names) {
  if (value === null || typeof value !== "object") {
    const [name, ...objects] = names;
    yield [objects.length ? `${name}(${objects.join(", ")})` : name, value];
    return;
  }
  for (const [name, inner] of Object.entries(value)) yield* said_of(inner, [...names, name]);
}
