// What rulec answers, as elements.

import { counted, element } from "./dom.js";

const lines = (...texts) => texts.filter(Boolean).map((text) => element("p", {}, text));

/** A finding; `onShow` leads to its place, `onFix` mends it. */
export function finding(one, onShow, onFix) {
  const place = one.place?.line ? `line ${one.place.line}` : "";
  const inSource = one.isOwn && place;
  const where = inSource
    ? element("button", { type: "button", class: "place", onclick: () => onShow(one.place) }, place)
    : element("span", { class: "place" }, [one.place?.file?.split("/").at(-1), place].filter(Boolean).join(", "));
  const fix =
    one.fix && one.isOwn
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

/** A message, in which rulec puts what is written in a source between backticks. */
const said = (text) =>
  text.split("`").map((part, n) => (n % 2 ? element("code", {}, part) : part));

/** What is wrong with a question: findings, what cannot be done here, or a failure. */
export function trouble(answer) {
  if (answer.findings) return element("ul", { class: "findings" }, answer.findings.map((one) => finding(one)));
  if (answer.refused) return element("p", {}, ...said(answer.refused));
  return element("p", { class: "error" }, `rulec itself has failed, which is a mistake of ours: ${answer.failure}`);
}

/** The examples, those of the rulebook's own rules first, and those that are missing. */
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
    rule.missing_edges.map((edge) =>
      element(
        "li",
        {},
        `No example of ${rule.rule} has this: `,
        element("code", {}, edge.example),
        " ",
        onInsert(rule.rule, edge.example),
      ),
    ),
  );
  const failed = others.filter((item) => item.className === "fail");
  return [
    element("ul", { class: "plain" }, [...owned, ...failed]),
    missing.length ? element("h3", {}, "Not tried by any example") : null,
    missing.length ? element("ul", { class: "plain" }, missing) : null,
    others.length
      ? element(
          "details",
          {},
          element("summary", {}, `${counted(others.length, "example")} that the rulebook inherits`),
          element("ul", { class: "plain" }, others.filter((item) => item.className === "pass")),
        )
      : null,
  ];
}

/** The rules in plain language. */
export const rules = ({ rules: listed, rulebook }) =>
  listed
    .toSorted((a, b) => (b.book === rulebook) - (a.book === rulebook))
    .map((rule) =>
      element(
        "article",
        {},
        element("h3", {}, `${rule.name} `, element("small", {}, [rule.strength, rule.cite, rule.book === rulebook ? "" : `from ${rule.book}`].filter(Boolean).join(" · "))),
        ...lines(rule.sentence, ...rule.restrictions),
        rule.says ? element("p", { class: "says" }, rule.says) : null,
      ),
    );

/** A verdict on a trace. */
export function verdict(one) {
  if (one.findings) return trouble(one);
  const word = one.satisfied ? (one.violations.length ? "satisfied, but for soft rules" : "satisfied") : "violated";
  return element(
    "article",
    { class: one.satisfied ? "kept" : "lost" },
    element("h3", {}, `${one.trace}: `, element("b", {}, word)),
    ...one.violations.map(violation),
  );
}

const bound = (binding) =>
  Object.entries(binding).map(([variable, object]) => `${variable} = ${object}`).join(", ");

function violation(one) {
  const told = one.explanation;
  const after = one.step === null ? "violated by how it ends" : `cannot be kept any more after state ${one.step}`;
  const about = bound(one.binding) ? ` for ${bound(one.binding)}` : "";
  return element(
    "div",
    { class: "violation" },
    element("p", {}, `${one.strength} rule `, element("b", {}, one.rule), told?.cite ? ` [${told.cite}]` : "", `${about}: ${after}`),
    told?.says ? element("p", { class: "says" }, told.says) : null,
    told ? explained(told) : null,
  );
}

function explained({ states, decisive, facts, parts }) {
  const at = states.indexOf(decisive);
  const rows = [
    ...facts.map(({ reads, unit, values, changed }) => [`${reads}${unit ? ` in ${unit}` : ""}`, values, changed, 0]),
    ...parts.map(({ formula, values, changed, depth }) => [formula, values, changed, depth]),
  ];
  return table(
    "State by state; * marks what changed when the rule was lost",
    states.map(String),
    rows.map(([title, values, changed, depth], n) => ({
      title,
      depth,
      begins: n === facts.length,
      cells: values.map((value, place) => shown(value) + (changed && place === at && n < facts.length ? "*" : "")),
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

/** What differs, rule by rule; `onTry` judges a trace that was found. */
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
  return [
    ...differing.map((pair) =>
      element(
        "article",
        {},
        element("h3", {}, `${pair.rule}: `, element("b", {}, filled(RELATIONS[pair.relation]))),
        element("p", { class: "says" }, `${names.first}: ${[pair.first.cite, pair.first.says].filter(Boolean).join(", ")}`),
        element("p", { class: "says" }, `${names.second}: ${[pair.second.cite, pair.second.says].filter(Boolean).join(", ")}`),
        pair.undecided ? element("p", {}, pair.undecided) : null,
        ...traces(pair).flat(),
      ),
    ),
    same.length ? element("p", {}, `The same in both: ${same.join(", ")}`) : null,
    alone(`Only in ${names.first}`, diff.only_first),
    alone(`Only in ${names.second}`, diff.only_second),
    diff.settings.length
      ? element("p", {}, `Set otherwise: ${diff.settings.map((one) => `${one.name} (${one.first} in ${names.first}, ${one.second} in ${names.second})`).join(", ")}`)
      : null,
  ];
}

/** A trace as a table of what its states say. */
function states(trace) {
  const rows = new Map();
  trace.states.forEach((state, n) => {
    for (const [name, value] of said_of(state, [])) {
      if (!rows.has(name)) rows.set(name, trace.states.map(() => ""));
      rows.get(name)[n] = shown(value);
    }
  });
  return table(
    `Objects: ${Object.entries(trace.objects).map(([name, type]) => `${name} (${type})`).join(", ") || "none"}; what is not said has its default`,
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
