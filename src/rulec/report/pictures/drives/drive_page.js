"use strict";
const scene = JSON.parse(document.getElementById("data").textContent);
const byId = (name) => document.getElementById(name);
const SVG = "http://www.w3.org/2000/svg";
document.documentElement.classList.add("scripted");

function make(parent, name, attributes = {}, text = "") {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text) element.textContent = text;
  parent.append(element);
  return element;
}

function put(parent, name, text = "", className = "") {
  const element = document.createElement(name);
  if (className) element.className = className;
  if (text) element.textContent = text;
  parent.append(element);
  return element;
}

// Differences to values, centimetres to metres.
function sums(steps, unit) {
  let sum = 0;
  return steps.map((step) => (sum += step) / unit);
}

function points(steps) {
  let x = 0, y = 0;
  const result = [];
  for (let n = 0; n < steps.length; n += 2) result.push([(x += steps[n]) / 100, (y += steps[n + 1]) / 100]);
  return result;
}

const joined = (line) => line.map(([x, y]) => `${x},${y}`).join(" ");
const last = scene.states - 1;
const seconds = (state) => scene.start + state * scene.step;
const decimals = Math.min(3, (String(scene.step).split(".")[1] || "").length);

const timed = (state) => `${seconds(state).toFixed(decimals)} s`;

// Bodies: poses by state, in metres and radians.
for (const body of scene.bodies) {
  for (const name of ["x", "y"]) body[name] = sums(body[name], 100);
  body.turn = sums(body.turn, 1000);
  body.speed = sums(body.speed, 1);
  body.shapes = body.shapes.map(points);
  body.shape = sums(body.shape, 1);
  body.there = [];
  for (const [gone, length] of body.runs) for (let n = 0; n < length; n++) body.there.push(!gone);
}

// A pose between two states; null where the body is not there.
function pose(body, at) {
  const row = at - body.first;
  const before = Math.floor(row), after = Math.min(Math.ceil(row), body.states - 1);
  if (before < 0 || row > body.states - 1 + 0.999) return null;
  const low = Math.min(before, body.states - 1);
  if (body.there.length && !body.there[low]) return null;
  const end = body.there.length && !body.there[after] ? low : after;
  const of = (values, n) => values[Math.min(n, values.length - 1)];
  const part = row - before;
  const between = (values) => of(values, low) + part * (of(values, end) - of(values, low));
  const shape = body.shape.length ? of(body.shape, low) : 0;
  return { x: between(body.x), y: between(body.y), turn: between(body.turn), speed: of(body.speed, low), shape };
}

// The map: a group in metres, y upwards, below one in pixels.
const map = byId("map");
const world = make(map, "g");
const above = make(map, "g");
const ground = make(world, "g");
for (const [surface, tip, ring] of scene.areas) {
  make(make(ground, "polygon", { class: surface, points: joined(points(ring)) }), "title", {}, tip);
}
for (const [kind, line] of scene.marks) make(ground, "polyline", { class: kind, points: joined(points(line)) });
const ego = scene.bodies[0];
const way = ego.x.map((x, n) => [x, ego.y[n]]);
make(ground, "polyline", { class: "trail", points: joined(way) });

const lights = scene.lights.map(([steps, colours]) => {
  const line = points(steps);
  make(ground, "polyline", { class: "stopline", points: joined(line) });
  const mark = make(above, "g");
  make(mark, "circle", { r: 8 });
  const letter = make(mark, "text", { class: "plain" });
  const tip = make(mark, "title");
  return { at: line[0].map((x, n) => (x + line[1][n]) / 2), colours, mark, letter, tip };
});
const signs = scene.signs.map(([x, y, text, name]) => {
  const mark = make(above, "g");
  const width = text.length * 7.4 + 8;
  make(mark, "rect", { class: "board", x: -width / 2, y: -9, width, height: 18, rx: 3 });
  make(mark, "text", { class: "plain" }, text);
  make(mark, "title", {}, `sign: ${name}`);
  return { at: [x, y], mark };
});

// The smaller above the larger, so that nobody is hidden.
for (const body of scene.bodies) {
  const [ring] = body.shapes;
  const reach = (n) => Math.max(...ring.map((place) => place[n])) - Math.min(...ring.map((place) => place[n]));
  body.area = ring ? reach(0) * reach(1) : 0;
}
for (const body of [...scene.bodies].sort((one, other) => other.area - one.area)) {
  body.drawn = make(world, "g");
  body.outline = make(body.drawn, "polygon");
  body.front = make(body.drawn, "polyline", { class: "front" });
  body.tip = make(body.drawn, "title");
  body.label = make(above, "text");
  body.last = -1;
}
const link = make(world, "polyline", { class: "link" });
const gap = make(above, "text", { class: "gap" });
const bar = make(above, "polyline", { class: "bar" });
const barText = make(above, "text");

function shaped(body, number) {
  const ring = body.shapes[number];
  const xs = ring.map(([x]) => x), ys = ring.map(([, y]) => y);
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  body.outline.setAttribute("points", joined(ring));
  const nose = x1 - 0.26 * (x1 - x0);
  body.front.setAttribute("points", x1 - x0 > 1.2 * (y1 - y0) ? joined([[nose, y0], [nose, y1]]) : "");
  body.reach = Math.hypot(x1 - x0, y1 - y0) / 2;
  body.last = number;
}

const calm = matchMedia("(prefers-reduced-motion: reduce)");
let at = scene.state, chosen = scene.chosen, playing = false, before = 0;
let scale = 8, centre = [ego.x[0], ego.y[0]];
const slider = byId("slider"), follow = byId("follow"), names = byId("names"), rate = byId("rate");
const violations = scene.violations;

function within(violation, state) {
  return violation && state >= violation.first && state < violation.first + violation.gaps.length;
}
for (const violation of violations) violation.links = violation.links.map((column) => sums(column, 100));

function draw() {
  const { clientWidth: width, clientHeight: height } = map;
  if (!width) return;
  const state = Math.round(at);
  const own = pose(ego, at);
  if (follow.checked && own) centre = [own.x, own.y];
  const [tx, ty] = [width / 2 - centre[0] * scale, height / 2 + centre[1] * scale];
  const there = ([x, y]) => [tx + x * scale, ty - y * scale];
  map.setAttribute("viewBox", `0 0 ${width} ${height}`);
  world.setAttribute("transform", `matrix(${scale} 0 0 ${-scale} ${tx} ${ty})`);
  const violation = violations[chosen];
  const against = new Set(violation ? violation.against : []);
  const taken = [];
  const free = (x, y, text) => {
    const half = text.length * 3.7 + 2;
    const box = [x - half, y - 8, x + half, y + 8];
    if (taken.some((one) => box[0] < one[2] && one[0] < box[2] && box[1] < one[3] && one[1] < box[3])) return false;
    taken.push(box);
    return true;
  };
  for (const { at: place, colours, mark, letter, tip } of lights) {
    const colour = colours.filter(([first]) => first <= state).pop()[1];
    const [x, y] = there(place);
    mark.setAttribute("transform", `translate(${x} ${y})`);
    mark.firstChild.setAttribute("class", { red: "red", yellow: "yellow", redYellow: "red", green: "green" }[colour] || "inactive");
    letter.textContent = colour === "redYellow" ? "RY" : colour.slice(0, 1).toUpperCase();
    tip.textContent = `light: ${colour}`;
    taken.push([x - 9, y - 9, x + 9, y + 9]);
  }
  for (const { at: place, mark } of signs) {
    const [x, y] = there(place);
    mark.setAttribute("transform", `translate(${x} ${y})`);
    const wide = mark.querySelector("text").textContent;
    mark.setAttribute("display", scale >= 3 && free(x, y, `${wide}  `) ? "inline" : "none");
  }
  const seen = within(violation, state);
  const labels = [];
  for (const body of scene.bodies) {
    const now = pose(body, at);
    const kind = body === ego ? "own" : against.has(body.id) ? "against" : "vehicle";
    body.drawn.setAttribute("display", now ? "inline" : "none");
    body.label.setAttribute("display", "none");
    if (!now) continue;
    if (now.shape !== body.last) shaped(body, now.shape);
    body.drawn.setAttribute("class", kind);
    body.outline.setAttribute("class", kind);
    // Never smaller than some pixels.
    const large = Math.max(1, 5 / (body.reach * scale));
    const [c, s] = [large * Math.cos(now.turn), large * Math.sin(now.turn)];
    body.drawn.setAttribute("transform", `matrix(${c} ${s} ${-s} ${c} ${now.x} ${now.y})`);
    body.tip.textContent = `${body.id}, ${body.type}, ${now.speed} km/h`;
    const [x, y] = there([now.x, now.y]);
    if (x < 0 || y < 0 || x > width || y > height) continue;
    labels.push([body, kind, now, x, y]);
    if (kind !== "vehicle") taken.push([x - 8, y - 8, x + 8, y + 8]);
  }
  link.setAttribute("display", seen ? "inline" : "none");
  gap.setAttribute("display", seen ? "inline" : "none");
  if (seen) {
    const row = state - violation.first;
    const [ax, ay, bx, by] = violation.links.map((column) => column[row]);
    const text = violation.gaps[row];
    link.setAttribute("points", joined([[ax, ay], [bx, by]]));
    const [x, y] = there([(ax + bx) / 2, (ay + by) / 2]);
    const tries = [14, 22, 30, 40, 55].flatMap((d) => [[0, -d], [0, d], [1.8 * d, 0], [-1.8 * d, 0]]);
    const found = text && tries.find(([dx, dy]) => free(x + dx, y + dy, `${text}  `));
    gap.textContent = found ? text : "";
    if (found) place(gap, x + found[0], y + found[1]);
  }
  const order = ["own", "against", "vehicle"];
  labels.sort((one, other) => order.indexOf(one[1]) - order.indexOf(other[1]));
  for (const [body, kind, now, x, y] of names.checked ? labels : []) {
    const text = kind === "vehicle" ? body.id : `${body.id} · ${now.speed} km/h`;
    // How far the body reaches up and down in the picture.
    const [cos, sin] = [Math.abs(Math.cos(now.turn)), Math.abs(Math.sin(now.turn))];
    const up = Math.min(body.reach * scale, (body.reach * sin + 0.9 * cos) * scale) + 10;
    const spots = [[x, y - up], [x, y + up], [x, y - up - 16], [x, y + up + 16]];
    const spot = spots.slice(0, kind === "vehicle" ? 2 : 4).find(([u, v]) => free(u, v, text));
    if (!spot || (scale < 2.5 && kind === "vehicle")) continue;
    body.label.textContent = text;
    body.label.setAttribute("class", kind === "vehicle" ? "other" : "");
    body.label.setAttribute("display", "inline");
    place(body.label, ...spot);
  }
  const metres = [5, 10, 20, 50, 100, 200, 500].find((length) => length * scale > 60) || 1000;
  const [right, low] = [width - 14, height - 12];
  bar.setAttribute("points", joined([[right - metres * scale, low - 5], [right - metres * scale, low], [right, low], [right, low - 5]]));
  barText.textContent = `${metres} m`;
  place(barText, right - (metres * scale) / 2, low - 10);

  slider.value = state;
  const text = timed(state);
  byId("time").textContent = `${text} of ${timed(last)}`;
  slider.setAttribute("aria-valuetext", text);
  for (const cursor of document.querySelectorAll(".cursor")) cursor.style.left = `${(100 * (state + 0.5)) / scene.states}%`;
  for (const row of shownRows) row.now.textContent = valueAt(row, state);
}

function place(element, x, y) {
  element.setAttribute("x", x);
  element.setAttribute("y", y);
}

// What the chosen violation's rule reads, a strip for each.
let shownRows = [];

function runAt(row, state) {
  return row.runs.find(([end]) => state <= end);
}

function valueAt(row, state) {
  const run = runAt(row, state);
  const value = run.length < 2 ? "not there" : run[1] === null ? "unknown" : String(run[3] ?? run[1]);
  return row.narrowly[state] ? `${value}: ${row.narrowly[state]}` : value;
}

function strip(parent, row, moment) {
  const element = put(parent, "div", "", "row");
  const head = put(element, "div", "", "name");
  put(head, "span", row.title);
  row.now = put(head, "span", "", "now");
  const drawing = put(element, "div", "", "strip");
  const share = (states) => `${(100 * states) / scene.states}%`;
  let first = 0, line = [];
  const numbers = row.number ? row.runs.map((run) => run[1]).filter((value) => typeof value === "number") : [];
  const [low, high] = [Math.min(...numbers), Math.max(...numbers)];
  const y = (value) => (high > low ? 15 - (14 * (value - low)) / (high - low) : 8);
  const lines = [];
  for (const [to, value, style] of [...row.runs, [last]]) {
    if (style === "curve") line.push([first, y(value)], [to + 1, y(value)]);
    else if (line.length) lines.push(line.splice(0));
    if (style && style !== "curve") {
      const box = put(drawing, "i", "", style);
      box.style.left = share(first);
      box.style.width = share(to + 1 - first);
      box.title = `${value === null ? "unknown" : value}, ${timed(first)} to ${timed(to)}`;
    }
    first = to + 1;
  }
  if (lines.length) {
    const curves = make(drawing, "svg", { viewBox: `0 0 ${scene.states} 16`, preserveAspectRatio: "none", "aria-hidden": "true" });
    for (const one of lines) make(curves, "polyline", { class: "curve", points: joined(one) });
  }
  put(drawing, "u", "", "moment").style.left = share(moment + 0.5);
  put(drawing, "u", "", "cursor");
  drawing.addEventListener("click", (event) => {
    const box = drawing.getBoundingClientRect();
    play(false);
    go(Math.floor(((event.clientX - box.left) / box.width) * scene.states));
  });
}

function swatch(parent, className, text) {
  const label = put(parent, "span");
  const drawing = make(label, "svg", { "aria-hidden": "true" });
  if (["solid", "broken", "unsaid", "trail", "link"].includes(className)) make(drawing, "line", { class: className, x1: 0, x2: 26, y1: 7, y2: 7 });
  else make(drawing, "rect", { class: className, x: 1, y: 1, width: 24, height: 11 });
  label.append(text);
}

function choose(number, jump) {
  chosen = number;
  const violation = violations[number];
  document.querySelectorAll("#violations button").forEach((button, n) => {
    button.setAttribute("aria-current", String(n === number));
    if (n === number) button.parentElement.parentElement.scrollTop = button.offsetTop - button.parentElement.parentElement.offsetTop - 60;
  });
  byId("details").hidden = !violation;
  for (const name of ["rows", "others", "measured", "values"]) byId(name).textContent = "";
  shownRows = [];
  if (violation) {
    byId("says").textContent = violation.says;
    for (const text of violation.measured) put(byId("measured"), "li", text, "number");
    shownRows = violation.rows;
    for (const row of shownRows) strip(byId(row.decides ? "rows" : "others"), row, violation.state);
    const others = shownRows.filter((row) => !row.decides).length;
    byId("more").hidden = !others;
    byId("more").firstChild.textContent = `What else the rule reads (${others})`;
    const styles = new Set(shownRows.flatMap((row) => row.runs.map((run) => run[2])));
    const word = [...styles].find((name) => name && name.startsWith("word"));
    for (const [name, text] of [["true", "true"], ["off", "false"], [word, "other colours: a word each"], ["unknown", "unknown"]]) {
      if (name && styles.has(name)) put(put(byId("values"), "span"), "i", "", name).after(text);
    }
    byId("status").textContent = `${violation.time} s: ${violation.title}`;
    if (jump) go(violation.state);
  }
  draw();
}

function go(state) {
  at = Math.max(0, Math.min(last, state));
  draw();
}

function play(on) {
  playing = on && last > 0;
  if (playing && at >= last) at = 0;
  byId("play").textContent = playing ? "Pause" : "Play";
  before = performance.now();
  if (playing) requestAnimationFrame(frame);
}

let clock = 0;
function frame(now) {
  if (!playing) return;
  const old = at;
  clock = calm.matches ? Math.max(clock, at) : at;
  clock = Math.min(last, clock + (((now - before) / 1000) * Number(rate.value)) / scene.step);
  before = now;
  at = calm.matches ? Math.floor(clock) : clock;
  const passed = violations.findIndex((one) => old < one.state && one.state <= at);
  if (passed >= 0 && passed !== chosen) choose(passed, false);
  else draw();
  if (at >= last) play(false);
  else requestAnimationFrame(frame);
}

function zoom(factor, x = map.clientWidth / 2, y = map.clientHeight / 2) {
  const wanted = Math.max(0.5, Math.min(60, scale * factor));
  if (!follow.checked) {
    const [dx, dy] = [x - map.clientWidth / 2, y - map.clientHeight / 2];
    centre = [centre[0] + dx / scale - dx / wanted, centre[1] - dy / scale + dy / wanted];
  }
  scale = wanted;
  draw();
}

// Dragging and pinching.
const held = new Map();
map.addEventListener("pointerdown", (event) => {
  held.set(event.pointerId, [event.clientX, event.clientY]);
  map.setPointerCapture(event.pointerId);
  map.classList.add("held");
});
map.addEventListener("pointermove", (event) => {
  if (!held.has(event.pointerId)) return;
  const [x, y] = held.get(event.pointerId);
  const others = [...held].filter(([id]) => id !== event.pointerId).map(([, spot]) => spot);
  held.set(event.pointerId, [event.clientX, event.clientY]);
  if (others.length) {
    const far = (u, v) => Math.hypot(u - others[0][0], v - others[0][1]);
    zoom(far(event.clientX, event.clientY) / Math.max(far(x, y), 1));
  } else if (Math.hypot(event.clientX - x, event.clientY - y) > 0) {
    follow.checked = false;
    centre = [centre[0] - (event.clientX - x) / scale, centre[1] + (event.clientY - y) / scale];
    draw();
  }
});
for (const name of ["pointerup", "pointercancel"]) map.addEventListener(name, (event) => {
  held.delete(event.pointerId);
  map.classList.toggle("held", held.size > 0);
});
map.addEventListener("wheel", (event) => {
  event.preventDefault();
  const box = map.getBoundingClientRect();
  zoom(Math.exp(-event.deltaY / 400), event.clientX - box.left, event.clientY - box.top);
}, { passive: false });

byId("nearer").addEventListener("click", () => zoom(1.4));
byId("farther").addEventListener("click", () => zoom(1 / 1.4));
byId("play").addEventListener("click", () => play(!playing));
byId("back").addEventListener("click", () => { play(false); go(Math.ceil(at) - 1); });
byId("on").addEventListener("click", () => { play(false); go(Math.floor(at) + 1); });
slider.addEventListener("input", () => { play(false); go(Number(slider.value)); });
follow.addEventListener("change", draw);
names.addEventListener("change", draw);
byId("controls").addEventListener("submit", (event) => event.preventDefault());
byId("theme").value = document.documentElement.dataset.theme || "";
byId("theme").addEventListener("change", (event) => {
  if (event.target.value) document.documentElement.dataset.theme = event.target.value;
  else delete document.documentElement.dataset.theme;
});

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const kind = event.target.tagName;
  if (kind === "SELECT") return;
  const second = Math.max(1, Math.round(1 / scene.step));
  const by = event.shiftKey ? second : 1;
  const keys = {
    ArrowLeft: () => { play(false); go(Math.ceil(at) - by); },
    ArrowRight: () => { play(false); go(Math.floor(at) + by); },
    Home: () => { play(false); go(0); },
    End: () => { play(false); go(last); },
    "+": () => zoom(1.25),
    "-": () => zoom(0.8),
  };
  if (kind !== "BUTTON" && event.target.type !== "checkbox") keys[" "] = () => play(!playing);
  if (!keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
});

// What is listed.
const many = violations.length;
byId("count").textContent = many ? `${many} violation${many > 1 ? "s" : ""}` : "No violation";
violations.forEach((violation, number) => {
  const button = put(put(byId("violations"), "li"), "button");
  button.type = "button";
  put(button, "b", `${violation.time} s`);
  const words = put(button, "span", violation.rule.replaceAll("_", "_\u200b"));
  put(words, "small", violation.short);
  button.addEventListener("click", () => { play(false); choose(number, true); });
  const flag = put(byId("flags"), "i", "", violation.strength);
  flag.style.left = `${last ? (100 * violation.state) / last : 0}%`;
  flag.title = `${violation.time} s: ${violation.rule}`;
  flag.addEventListener("click", () => { play(false); choose(number, true); });
});
swatch(byId("legend"), "own", `ego, ${scene.ego}`);
if (violations.some((one) => one.against.length)) swatch(byId("legend"), "against", "whom the violation is against");
swatch(byId("legend"), "vehicle", "others");
swatch(byId("legend"), "trail", "ego’s way");
const kinds = new Set(scene.marks.map(([kind]) => kind));
for (const [kind, text] of [["solid", "solid mark"], ["broken", "broken mark"], ["unsaid", "bound without a mark"]]) {
  if (kinds.has(kind)) swatch(byId("legend"), kind, text);
}
if (scene.areas.some(([surface]) => surface === "crossing")) swatch(byId("legend"), "crossing", "pedestrian crossing");

// Ego and the other one in view at first.
function fit() {
  const violation = violations[chosen];
  let wide = 55;
  if (within(violation, scene.state)) {
    const [ax, ay, bx, by] = violation.links.map((column) => column[scene.state - violation.first]);
    wide = Math.max(wide, 2.6 * Math.hypot(bx - ax, by - ay) + 30);
  }
  scale = Math.min(map.clientWidth / (1.5 * wide), map.clientHeight / (0.75 * wide));
}
make(make(make(map, "defs"), "pattern", { id: "hatched", width: 6, height: 6, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" }), "rect", { width: 2, height: 6, fill: "currentColor", opacity: 0.35 });
new ResizeObserver(draw).observe(map);
fit();
choose(chosen, false);
