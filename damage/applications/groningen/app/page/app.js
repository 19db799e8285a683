"use strict";
const words = JSON.parse(document.getElementById("words").textContent);
const token = document.querySelector('meta[name="token"]').content;
const by = (id) => document.getElementById(id);
const fill = (key, values) => words[key].replace(/\{(\w+)\}/g, (_, name) => values[name]);
const shown = (value, digits = 2) => new Intl.NumberFormat(document.documentElement.lang,
  { maximumSignificantDigits: digits, useGrouping: false }).format(value);
const localized = (value) => String(value).replace(/[.,]/, document.documentElement.lang === "nl" ? "," : ".");
const number = (text) => text.trim() === "" ? null : Number(text.trim().replace(",", "."));
const field = (id) => number(by(id).value);
const MARGIN = 0.1;  // around the wall [m], as in photo.py

function say(id, text, bad = false) {
  const place = by(id);
  place.textContent = text;
  place.classList.toggle("bad", bad);
}

async function ask(name, given, said) {
  const options = given === undefined ? {} : {
    method: "POST", headers: { "X-Damage-Token": token, "Accept-Language": document.documentElement.lang, "Content-Type": given instanceof Blob ?
      "application/octet-stream" : "application/json" },
    body: given instanceof Blob ? given : JSON.stringify(given) };
  let found;
  try {
    const answer = await fetch(`api/${name}`, options);
    found = answer.headers.get("Content-Type") === "application/json" ? await answer.json() :
      { error: `HTTP ${answer.status}` };
  } catch (error) {
    found = { error: String(error) };
  }
  if (found.error !== undefined) {
    if (said) say(said, `${words.error} ${found.error}`, true);
    return null;
  }
  return found;
}

const cells = (row, texts) => texts.forEach((text) => { row.insertCell().textContent = text; });

// --- a canvas on which points are set and moved by mouse, touch and keys

class Board {
  // set(at): takes a point, shares of the canvas from above left; draw(pen, width, height): paints what it shows;
  // grip(at, near): what a point takes hold of, a function that moves it, or null; dropped(): called when it is let go
  constructor(canvas, set, draw, grip = () => null, dropped = () => {}) {
    Object.assign(this, { canvas, set, draw, grip, dropped, image: null, alpha: 1, cross: [0.5, 0.5], shown: false });
    let held = null;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      this.shown = false;
      return this.cross = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    };
    canvas.addEventListener("pointerdown", (event) => {
      const at = place(event);
      held = grip(at, 14 / canvas.getBoundingClientRect().width);
      if (held) canvas.setPointerCapture(event.pointerId);
      else set(at);
      this.paint();
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) return;
      held(place(event));
      this.paint();
    });
    for (const ends of ["pointerup", "pointercancel"]) canvas.addEventListener(ends, () => {
      if (held) dropped();
      held = null;
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
    canvas.addEventListener("blur", () => { this.shown = false; this.paint(); });
    this.keys = {};
  }
  key(event) {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (event.key in moves && this.step) {
      this.step(...moves[event.key], event.shiftKey);
    } else if (event.key in moves) {
      const step = event.shiftKey ? 0.001 : 0.01;
      const [across, down] = moves[event.key];
      const ratio = this.canvas.width / this.canvas.height;
      this.cross = [this.cross[0] + across * step, this.cross[1] + down * step * ratio].map((at) =>
        Math.min(1, Math.max(0, at)));
      this.shown = true;
      if (this.keyed) this.keyed(this.cross);
    } else if (event.key === "Enter" && this.keyed) {
      this.keyed = null;
      this.dropped();
    } else if (event.key === "Enter" && !this.step && (this.keyed = this.grip(this.cross, 0.02))) {
      this.keyed(this.cross);
    } else if (event.key === "Enter") {
      this.set(this.cross);
    } else if (event.key in this.keys) {
      this.keys[event.key]();
    } else {
      return;
    }
    event.preventDefault();
    this.paint();
  }
  size(width, height) {
    this.canvas.width = 1600;
    this.canvas.height = Math.round(1600 * height / width);
  }
  paint() {
    const { canvas } = this, pen = canvas.getContext("2d");
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.globalAlpha = this.alpha;
    if (this.image) pen.drawImage(this.image, 0, 0, canvas.width, canvas.height);
    pen.globalAlpha = 1;
    this.draw(pen, canvas.width, canvas.height);
    if (this.shown) {
      const [x, y] = [this.cross[0] * canvas.width, this.cross[1] * canvas.height];
      line(pen, [[x - 40, y], [x + 40, y]], "#d55e00", 3);
      line(pen, [[x, y - 40], [x, y + 40]], "#d55e00", 3);
    }
  }
}

function line(pen, points, colour, width) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.stroke();
}

function dot(pen, [x, y], colour, radius = 7) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = colour;
  pen.fill();
}

const picture = (file) => new Promise((done) => {
  const image = new Image();
  image.onload = () => done(image);
  image.onerror = () => done(null);
  image.src = `files/${file}?${Date.now()}`;
});

// --- photograph

let pixels = [];
// two opposite corners of each opening, behind the four points
const pairs = (points) => points.slice(4).flatMap((point, k, all) => (k % 2 ? [[all[k - 1], point]] : []));
const photo = new Board(by("photo"), (at) => {
  pixels.push([at[0] * photo.image.naturalWidth, at[1] * photo.image.naturalHeight]);
}, (pen, width, height) => {
  const scale = photo.image ? width / photo.image.naturalWidth : 1;
  const places = pixels.map(([x, y]) => [x * scale, y * scale]);
  const four = places.slice(0, 4);
  if (four.length) line(pen, four.length === 4 ? [...four, four[0]] : four, "#0072b2", 4);
  for (const pair of pairs(places)) line(pen, pair, "#009e73", 4);
  places.forEach((place) => dot(pen, place, "#d55e00", 11));
});
photo.keys.Backspace = () => pixels.pop();

async function showPhoto() {
  photo.image = await picture("photo.jpg");
  if (!photo.image) return;
  pixels = [];
  photo.size(photo.image.naturalWidth, photo.image.naturalHeight);
  by("photo-part").hidden = false;
  photo.paint();
}

by("photo-file").addEventListener("change", async (event) => {
  const [file] = event.target.files;
  if (!file || !(await ask("photograph", file, "said-photo"))) return;
  unstraight();
  say("said-photo", words.photo_kept);
  await showPhoto();
});

by("straighten").addEventListener("click", async () => {
  const places = [1, 2, 3, 4].map((k) => by(`point-${k}`).value.trim()).map((text) =>
    text.split(/[;\s]/.test(text) ? /[;\s]+/ : ",").map((part) => number(part.replace(/,$/, ""))));
  if (await ask("straighten", { pixels: pixels.slice(0, 4), places, openings: pairs(pixels) }, "said-photo")) {
    say("said-photo", words.straightened);
    await showStraight();
  }
});

function unstraight() {
  if (board.image) say("said-photo", words.straighten_again);
  board.image = null;
  by("for-overlay").hidden = true;
  board.paint();
}

async function showStraight() {
  board.image = await picture("straight.jpg");
  by("for-overlay").hidden = !board.image;
  overlaid();
}

// --- the front as a drawing

let front = null, table = null, chosen = null, unsent = false;
const rounded = (value) => Math.round(value * 1e4) / 1e4;
const nearest = (value, step) => rounded(Math.round(value / step) * step);
const isGable = () => table.outline && table.outline.length === 3;
const upmost = () => Math.max(table.height, ...(table.outline || []).map(([, z]) => z));
const scene = () => ({ wide: table.length + 2 * MARGIN, high: upmost() + 2 * MARGIN });
const spot = ([x, y]) => [x * scene().wide - MARGIN, upmost() + MARGIN - y * scene().high];
const course = () => (front ? front.course : 0.075), quarter = () => (front ? front.brick / 4 : 0.055);

function grip(at, near) {
  if (!table) return null;
  const [x, z] = spot(at), reach = near * scene().wide, openings = table.openings || [];
  for (const one of [...openings].reverse()) {
    const sill = one.sill || 0, start = { ...one, sill };
    const close = (px, pz) => Math.hypot(x - px, z - pz) < reach;
    const inside = x > one.left && x < one.left + one.width && z > sill && z < sill + one.height;
    const upper = close(one.left + one.width, sill + one.height), lower = close(one.left, sill);
    if (!inside && !upper && !lower) continue;
    choose(one);
    return (to) => {
      const [dx, dz] = [nearest(spot(to)[0] - x, quarter()), nearest(spot(to)[1] - z, course())];
      if (upper) stretch(one, start, dx, dz);
      else if (lower) {
        Object.assign(one, { left: rounded(start.left + dx), sill: Math.max(0, rounded(sill + dz)) });
        stretch(one, start, start.left - one.left, sill - one.sill);
      } else shift(one, start, dx, dz);
    };
  }
  const floor = (table.floors || []).find((one) => Math.abs(one.level - z) < reach);
  choose(floor || null);
  return floor ? (to) => shift(floor, floor, 0, nearest(spot(to)[1], course()) - floor.level) : null;
}

function shift(one, from, dx, dz) {
  if ("level" in one) one.level = Math.max(course(), rounded(from.level + dz));
  else Object.assign(one, { left: Math.max(0, rounded(from.left + dx)), sill: Math.max(0, rounded((from.sill || 0) + dz)) });
}

function stretch(one, from, dx, dz) {
  one.width = Math.max(2 * quarter(), rounded(from.width + dx));
  one.height = Math.max(course(), rounded(from.height + dz));
}

const sketch = new Board(by("sketch"), () => {}, drawSketch, grip, sent);
sketch.step = (across, down, larger) => {
  if (!chosen) return;
  if (larger && !("level" in chosen)) stretch(chosen, { ...chosen }, across * quarter(), -down * course());
  else shift(chosen, { ...chosen }, across * quarter(), -down * course());
  sent();
};
sketch.set = () => {
  const parts = [...(table.openings || []), ...(table.floors || [])];
  choose(parts[(parts.indexOf(chosen) + 1) % parts.length] || null);
};
sketch.keys.Delete = removePart;

function drawSketch(pen, width) {
  if (!table) return;
  const scale = width / scene().wide;
  const at = ([x, z]) => [(x + MARGIN) * scale, (upmost() + MARGIN - z) * scale];
  const box = (left, low, right, high) => [[left, low], [right, low], [right, high], [left, high], [left, low]].map(at);
  if (front && !unsent) bricks(pen, at, scale, "#8a8a8a");
  const roof = table.outline || [[0, table.height], [table.length, table.height]];
  line(pen, [...[[0, 0], [table.length, 0]], ...[...roof].reverse(), [0, 0]].map(at), "#0072b2", 5);
  for (const one of table.floors || []) {
    line(pen, [[one.left || 0, one.level], [one.right ?? table.length, one.level]].map(at), one === chosen ? "#d55e00" : "#b07d2b", 8);
  }
  pen.font = "30px sans-serif";
  for (const [k, one] of (table.openings || []).entries()) {
    const sill = one.sill || 0, colour = one === chosen ? "#d55e00" : "#009e73";
    line(pen, box(one.left, sill, one.left + one.width, sill + one.height), colour, 6);
    [[one.left, sill], [one.left + one.width, sill + one.height]].forEach((point) => dot(pen, at(point), colour, 13));
    pen.fillStyle = colour;
    const [x, y] = at([one.left, sill + one.height / 2]);
    pen.fillText(`${k + 1}: ${shown(one.width, 3)} × ${shown(one.height, 3)} m`, x + 14, y);
  }
}

function bricks(pen, at, scale, colour) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1;
  for (const [x, z, length, height] of front.bricks) {
    const [left, upper] = at([x - length / 2, z + height / 2]);
    pen.strokeRect(left, upper, length * scale, height * scale);
  }
}

const PART = ["left", "width", "height", "sill", "level", "mass"];
function choose(one) {
  chosen = one;
  filled();
}

// The fields show what the drawing has, but for one in which someone types.
function show(id, value) {
  if (document.activeElement !== by(id)) by(id).value = localized(value ?? "");
}
function filled() {
  const roof = isGable() ? table.outline[1][1] : null;
  const values = { length: table.length, eaves: isGable() ? table.outline[0][1] : table.height, ridge: roof,
    load: (table.precompression ?? 300e3) / 1e3 };
  for (const [name, value] of Object.entries(values)) {
    show(`wall-${name}`, value);
    by(`wall-${name}`).disabled = name === "ridge" && Boolean(table.outline) && !isGable();
  }
  by("part").hidden = by("remove-part").disabled = !chosen;
  by("part").hidden = !chosen;
  if (!chosen) return;
  const isFloor = "level" in chosen, list = isFloor ? table.floors : table.openings;
  by("part-name").textContent = `${words[isFloor ? "floor" : "opening"]} ${list.indexOf(chosen) + 1}`;
  for (const name of PART) {
    const here = ["level", "mass"].includes(name) === isFloor;
    by(`part-${name}`).closest("label").hidden = !here;
    if (here) show(`part-${name}`, chosen[name] ?? (name === "sill" ? 0 : null));
  }
}

for (const name of PART) {
  by(`part-${name}`).addEventListener("change", () => {
    const value = field(`part-${name}`);
    if (chosen && Number.isFinite(value)) chosen[name] = value;
    sent();
  });
}
for (const name of ["length", "eaves", "ridge", "load"]) {
  by(`wall-${name}`).addEventListener("change", () => {
    const value = field(`wall-${name}`);
    if (name === "load" && value !== null && Number.isFinite(value)) table.precompression = 1e3 * value;
    if (name === "length" && value > 0) table.length = value;
    if (name === "eaves" && value > 0) isGable() ? [0, 2].forEach((k) => { table.outline[k][1] = value; }) : (table.height = value);
    if (name === "ridge") {
      const eaves = isGable() ? table.outline[0][1] : table.height;
      if (value > eaves) Object.assign(table, { height: value, outline: [[0, eaves], [table.length / 2, value], [table.length, eaves]] });
      else { table.height = eaves; delete table.outline; }
    }
    if (isGable()) [table.outline[1][0], table.outline[2][0]] = [table.length / 2, table.length];
    sent();
  });
}
by("add-opening").addEventListener("click", () => {
  const width = nearest(0.9, quarter());
  table.openings = [...(table.openings || []), { left: nearest((table.length - width) / 2, quarter()), width,
    height: nearest(1.2, course()), sill: nearest(0.9, course()) }];
  choose(table.openings.at(-1));
  sent();
});
by("add-floor").addEventListener("click", () => {
  table.floors = [...(table.floors || []), { level: nearest(Math.min(2.7, isGable() ? table.outline[0][1] : table.height), course()), mass: 3000 }];
  choose(table.floors.at(-1));
  sent();
});
function removePart() {
  for (const name of ["openings", "floors"]) {
    table[name] = (table[name] || []).filter((one) => one !== chosen);
    if (!table[name].length) delete table[name];
  }
  choose(null);
  sent();
}
by("remove-part").addEventListener("click", removePart);

// The drawing goes to the program at each change; it answers with the bricks, or says what cannot be built.
let edits = 0;
async function sent() {
  const edit = edits += 1;
  unsent = true;
  filled();
  sketch.paint();
  const found = await ask("sketch", { table }, "said-front");
  if (found && edit === edits) showFront(found);
}

function tab(name) {
  for (const one of ["drawing", "text"]) {
    by(`tab-${one}`).setAttribute("aria-selected", one === name);
    by(`tab-${one}`).tabIndex = one === name ? 0 : -1;
    by(one).hidden = one !== name;
  }
}
for (const one of ["drawing", "text"]) {
  by(`tab-${one}`).addEventListener("click", () => tab(one));
  by(`tab-${one}`).addEventListener("keydown", (event) => {
    if (!["ArrowLeft", "ArrowRight"].includes(event.key)) return;
    const other = one === "text" ? "drawing" : "text";
    tab(other);
    by(`tab-${other}`).focus();
  });
}

// --- cracks on the front

let cracks = [], areas = [], open = [], joints = [];
const wide = () => front.length + 2 * MARGIN, high = () => front.height + 2 * MARGIN;
const placeAt = ([x, y]) => [x * wide() - MARGIN, front.height + MARGIN - y * high()];
const board = new Board(by("front"), (at) => {
  if (!front || by("tool").value === "move") return;
  const place = placeAt(at).map(rounded);
  const last = open[open.length - 1];
  if (last && last[0] === place[0] && last[1] === place[1]) return;
  open.push(place);
  if (by("tool").value === "area" && open.length === 2) finish();
  where();
}, drawFront, (at, near) => {
  if (!front || by("tool").value !== "move") return null;
  const [x, z] = placeAt(at);
  const found = cracks.flatMap((one) => one.points).map((point) => [Math.hypot(point[0] - x, point[1] - z), point])
    .sort((one, other) => one[0] - other[0])[0];
  if (!found || found[0] > 1.5 * near * wide()) return null;
  return (to) => { [found[1][0], found[1][1]] = placeAt(to).map(rounded); joints = []; };
}, () => changed());
board.keys = { f: finish, F: finish, Backspace: () => open.pop() };

function overlaid() {
  board.alpha = 1 - by("overlay").value / 100;
  board.paint();
}
by("overlay").addEventListener("input", overlaid);

function where() {
  if (!front) return;
  const [x, z] = placeAt(board.cross);
  by("cross").textContent = fill("cross_at", { x: shown(x, 3), z: shown(z, 3) });
}
by("front").addEventListener("keydown", where);

function drawFront(pen, width) {
  if (!front) return;
  const scale = width / wide();
  const at = ([x, z]) => [(x + MARGIN) * scale, (front.height + MARGIN - z) * scale];
  bricks(pen, at, scale, board.image ? "rgba(255,255,255,.35)" : "#8a8a8a");
  if (board.image) {
    line(pen, [...front.outline, front.outline[0]].map(at), "#56b4e9", 5);
    for (const [left, low, right, upper] of front.openings) {
      line(pen, [[left, low], [right, low], [right, upper], [left, upper], [left, low]].map(at), "#56b4e9", 5);
    }
  }
  for (const [x, z, right, top] of areas) {
    const [one, other] = [at([x, z]), at([right, top])];
    pen.fillStyle = "rgba(0,114,178,.15)";
    pen.fillRect(one[0], one[1], other[0] - one[0], other[1] - one[1]);
  }
  for (const [x, z, right, top] of joints) line(pen, [at([x, z]), at([right, top])], "#009e73", 9);
  pen.font = "bold 36px sans-serif";
  for (const crack of cracks) {
    line(pen, crack.points.map(at), "#d55e00", 4);
    if (by("tool").value === "move") crack.points.forEach((point) => dot(pen, at(point), "#d55e00", 10));
    const [x, y] = at(crack.points[0]);
    pen.lineWidth = 6;
    pen.strokeStyle = "#fff";
    pen.strokeText(crack.label, x + 12, y - 12);
    pen.fillStyle = "#d55e00";
    pen.fillText(crack.label, x + 12, y - 12);
  }
  if (open.length) line(pen, open.map(at), "#0072b2", 4);
  open.forEach((point) => dot(pen, at(point), "#0072b2"));
}
by("tool").addEventListener("change", () => {
  by("front").classList.toggle("moving", by("tool").value === "move");
  board.keyed = null;
  board.paint();
});

const fits = { width: (value) => value >= 0.001 && value <= 1000, limit: (value) => value >= 0.001 && value <= 100,
  error: (value) => value !== null && value >= 0 && value <= 100 };
function checked(input, kind) {
  const fine = fits[kind](number(input.value));
  input.setAttribute("aria-invalid", !fine);
  if (!fine) say("said-cracks", words[`bad_${kind}`], true);
  else if (by("said-cracks").textContent === words[`bad_${kind}`]) say("said-cracks", "");
  return fine;
}
for (const kind of Object.keys(fits)) by(kind).addEventListener("input", () => checked(by(kind), kind));

const letters = (k) => (k >= 26 ? letters(Math.floor(k / 26) - 1) : "") + String.fromCharCode(65 + k % 26);
function freeLabel() {
  const taken = cracks.map((one) => one.label);
  let k = 0;
  while (taken.includes(letters(k))) k += 1;
  return letters(k);
}

function finish() {
  if (open.length < 2) return;
  if (by("tool").value === "area") {
    areas.push([...open[0], ...open[1]]);
  } else {
    if (!checked(by("width"), "width")) return;
    cracks.push({ label: freeLabel(), points: open, width_mm: field("width"), offset: by("offset").value });
  }
  open = [];
  changed();
}

function undo() {
  if (open.length) open.pop();
  else (by("tool").value === "area" ? areas : cracks).pop();
  changed();
}

function cell(row, value, take, name) {
  const input = document.createElement("input");
  input.value = value;
  input.size = 5;
  input.setAttribute("aria-label", name);
  input.addEventListener("change", () => { joints = []; take(input); board.paint(); keep(); });
  row.insertCell().append(input);
}

function changed() {
  joints = [];
  const body = by("drawn").tBodies[0];
  body.replaceChildren();
  const lines = [...cracks.map((one) => [cracks, one]), ...areas.map((one) => [areas, one])];
  for (const [list, one] of lines) {
    const row = body.insertRow(), isCrack = list === cracks;
    if (isCrack) {
      cell(row, one.label, (input) => {
        const label = input.value.trim();
        const free = label && !cracks.some((other) => other !== one && other.label === label);
        input.setAttribute("aria-invalid", !free);
        if (free) one.label = label;
        else say("said-cracks", words.bad_label, true);
      }, words.label);
      const length = one.points.slice(1).reduce((sum, [x, z], k) => sum + Math.hypot(x - one.points[k][0], z - one.points[k][1]), 0);
      cells(row, [shown(length, 3)]);
      cell(row, localized(one.width_mm), (input) => { if (checked(input, "width")) one.width_mm = number(input.value); },
        `${words.width} ${one.label}`);
      cells(row, [words[one.offset]]);
    } else cells(row, [words.area, "", "", ""]);
    const button = document.createElement("button");
    button.textContent = words.delete;
    button.addEventListener("click", () => { list.splice(list.indexOf(one), 1); changed(); });
    row.insertCell().append(button);
  }
  by("drawn").hidden = lines.length === 0;
  board.paint();
  keep();
}

by("finish").addEventListener("click", finish);
by("undo").addEventListener("click", undo);

const survey = () => ({ cracks, areas: areas.map(([x, z, right, top]) => [[x, z], [right, top]]),
  limit_mm: field("limit"), error_mm: field("error") });

function showJoints(found) {
  joints = found.joints;
  say("said-cracks", fill("share", { share: shown(100 * found.share_on_joints, 3), length: shown(found.crack_length_m, 3),
    apart: shown(1000 * found.apart_m, 2) }));
  board.paint();
}

async function putOnJoints() {
  finish();
  const found = await ask("survey", survey(), "said-cracks");
  if (found) showJoints(found);
  return Boolean(found);
}
by("put-on-joints").addEventListener("click", putOnJoints);

function showFront(found) {
  const place = chosen && [..."openings floors".split(" ").map((name) => [name, (table[name] || []).indexOf(chosen)])].find(([, k]) => k >= 0);
  const typed = front ? String(front.corners) === String(found.corners) : by("point-1").value !== "";
  [front, table, unsent] = [found, found.table, false];
  if (!table.outline) table.height = rounded(found.height);
  found.openings.forEach(([, low, , upper], k) => Object.assign(table.openings[k], { sill: low, height: rounded(upper - low) }));
  chosen = place ? (table[place[0]] || [])[place[1]] || null : null;
  by("front-text").value = found.text;
  by("outside").textContent = found.outside[document.documentElement.lang];
  say("said-front", fill("front_is", { name: words[`front_${found.name}`] ?? found.name, length: shown(found.length, 4), height: shown(found.height, 4),
    points: found.contact_points }));
  if (!typed) found.corners.forEach(([x, z], k) => { by(`point-${k + 1}`).value = [x, z].map((value) => localized(rounded(value))).join(" "); });
  sketch.size(scene().wide, scene().high);
  filled();
  sketch.paint();
  board.size(wide(), high());
  if (!found.straight) unstraight();
  board.paint();
  keep();
}

async function useText() {
  const found = await ask("front", { text: by("front-text").value }, "said-front");
  if (!found) return;
  showFront(found);
  changed();
}
by("front-text").addEventListener("change", useText);

// --- address, settlement, runs

async function showEarthquakes() {
  const found = await ask("address", { latitude: field("latitude"), longitude: field("longitude") }, "said-address");
  if (!found) return;
  const body = by("earthquakes").tBodies[0];
  body.replaceChildren();
  for (const event of found.events) {
    cells(body.insertRow(), [event.time_utc.slice(0, 16).replace("T", " "), shown(event.magnitude), event.place, shown(event.epicentral_km),
      shown(event.median_mm_s, 3), shown(event.one_percent_mm_s, 3)]);
  }
  by("earthquakes").hidden = false;
  say("said-address", "");
  const ends = document.createElement("strong");
  ends.textContent = fill("catalogue_ends", { date: found.catalogue_ends });
  by("said-address").append(ends, ...found.warnings.map((one) => ` ${one}`));
}
by("show-earthquakes").addEventListener("click", showEarthquakes);

by("settle").addEventListener("change", () => {
  const chosen = by("settle").value;
  by("for-levels").hidden = chosen !== "levels";
  by("for-distortion").hidden = chosen === "" || chosen === "levels";
});

async function useLevels() {
  const found = await ask("levels", { text: by("levels-text").value }, "said-settlement");
  if (!found) return false;
  const most = Math.max(...found.uz_m) - Math.min(...found.uz_m);
  say("said-settlement", [fill("levels_are", { most: shown(1000 * most) }), ...found.notes].join(" "));
  return true;
}
by("use-levels").addEventListener("click", useLevels);

let timer = null;
function showProgress(found) {
  by("stop").disabled = !found.running;
  by("start").disabled = found.running;
  by("for-log").hidden = found.lines.length === 0;
  by("share").hidden = !found.running;
  if (found.share === null) by("share").removeAttribute("value");
  else by("share").value = found.share;
  by("log").textContent = found.lines.join("\n");
  by("sheet").hidden = !found.sheet || found.running;
  by("more").textContent = found.more;
  const key = found.running ? "running" : found.status === null ? null : found.status === 0 ? "done" :
    found.status < 0 || found.status === 130 || found.status === 143 ? "stopped" : "failed";
  const pace = found.running && found.lines.filter((one) => one.includes(" %")).at(-1);
  if (key) say("said-compute", pace ? `${words[key]} ${pace}` : words[key], key === "failed");
  clearTimeout(timer);
  if (found.running) timer = setTimeout(() => compute("progress"), 1000);
}

async function compute(name, given) {
  const found = await ask(name, given, "said-compute");
  if (found) showProgress(found);
}

// What the page shows is what runs: survey and levels are sent first.
by("start").addEventListener("click", async () => {
  const settle = by("settle").value || null;
  if (by("front-text").value !== front?.text) await useText();
  if (unsent || by("front-text").value !== front?.text) return say("said-compute", fill("see_step", { step: 2 }), true);
  if (Number.isNaN(field("draws"))) return say("said-compute", words.bad_draws, true);
  if (!(await putOnJoints())) return say("said-compute", fill("see_step", { step: 4 }), true);
  if (settle === "levels" && !(await useLevels())) return say("said-compute", fill("see_step", { step: 5 }), true);
  compute("start", { latitude: field("latitude"), longitude: field("longitude"), settle,
    distortion: settle && settle !== "levels" ? 1 / field("distortion") : null, draws: field("draws"),
    units: by("units").value.split(" ").map(Number), language: document.documentElement.lang });
});
by("stop").addEventListener("click", () => compute("stop", {}));

// What is drawn and typed outlives a reload, a change of language and the end of the browser.
let draft = null;
function keep() {
  if (!draft) return;
  const fields = {};
  for (const one of document.querySelectorAll("input:not([type=file]), select, textarea")) fields[one.id] = one.value;
  localStorage.setItem(draft, JSON.stringify({ cracks, areas, open, pixels, fields, table: unsent ? table : null }));
}
document.addEventListener("input", keep);
window.addEventListener("pagehide", keep);

async function begin() {
  const state = await ask("state", undefined, "said-front");
  if (!state) return;
  for (const name of Object.keys(state.fronts)) by("fronts").add(new Option(words[`front_${name}`], name));
  by("fronts").addEventListener("change", () => {
    by("front-text").value = state.fronts[by("fronts").value];
    useText();
  });
  by("front-text").value = state.front ? state.front.text : state.fronts[by("fronts").value];
  const kept = JSON.parse(localStorage.getItem(`damage ${state.folder}`) || "null");
  for (const [id, value] of Object.entries(kept ? kept.fields : {})) if (id && by(id)) by(id).value = value;
  for (const one of document.querySelectorAll("[inputmode=decimal]")) one.value = localized(one.value);
  const text = by("front-text").value;
  if (state.front) showFront(state.front);
  else await useText();
  if (text !== by("front-text").value) by("front-text").value = text;
  const drawn = kept || state.drawn;
  if (drawn) [cracks, areas, open] = [drawn.cracks, drawn.areas, drawn.open || []];
  if (!kept && drawn) [by("limit").value, by("error").value] = [drawn.limit_mm, drawn.error_mm].map(localized);
  if (kept && kept.table) {
    table = kept.table;
    await sent();
  }
  draft = `damage ${state.folder}`;
  tab("drawing");
  changed();
  const same = (one) => JSON.stringify([one.cracks, one.areas]);
  if (state.survey && same({ cracks, areas }) === same(state.drawn)) showJoints(state.survey);
  if (field("latitude") !== null && field("longitude") !== null) await showEarthquakes();
  by("settle").dispatchEvent(new Event("change"));
  if (state.photo) await showPhoto();
  if (kept && kept.pixels) pixels = kept.pixels;
  photo.paint();
  if (state.straight) await showStraight();
  showProgress(state);
  document.body.dataset.ready = "yes";
}
begin();
