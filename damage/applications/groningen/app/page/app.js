"use strict";
const words = JSON.parse(document.getElementById("words").textContent);
const token = document.querySelector('meta[name="token"]').content;
const by = (id) => document.getElementById(id);
const fill = (key, values) => words[key].replace(/\{(\w+)\}/g, (_, name) => values[name]);
const shown = (value, digits = 2) => new Intl.NumberFormat(document.documentElement.lang,
  { maximumSignificantDigits: digits, useGrouping: false }).format(value);
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
    method: "POST", headers: { "X-Damage-Token": token, "Content-Type": given instanceof Blob ?
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

// --- a canvas on which points are set by mouse and keys

class Board {
  // set(at): takes a point, shares of the canvas from above left; draw(pen, width, height): paints what it shows
  constructor(canvas, set, draw) {
    Object.assign(this, { canvas, set, draw, image: null, cross: [0.5, 0.5], shown: false });
    canvas.addEventListener("pointerdown", (event) => {
      const box = canvas.getBoundingClientRect();
      this.cross = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
      this.shown = false;
      set(this.cross);
      this.paint();
    });
    canvas.addEventListener("keydown", (event) => this.key(event));
    canvas.addEventListener("blur", () => { this.shown = false; this.paint(); });
    this.keys = {};
  }
  key(event) {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (event.key in moves) {
      const step = event.shiftKey ? 0.001 : 0.01;
      const [across, down] = moves[event.key];
      const ratio = this.canvas.width / this.canvas.height;
      this.cross = [this.cross[0] + across * step, this.cross[1] + down * step * ratio].map((at) =>
        Math.min(1, Math.max(0, at)));
      this.shown = true;
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
    if (this.image) pen.drawImage(this.image, 0, 0, canvas.width, canvas.height);
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
const photo = new Board(by("photo"), (at) => {
  if (pixels.length < 4) pixels.push([at[0] * photo.image.naturalWidth, at[1] * photo.image.naturalHeight]);
}, (pen, width, height) => {
  const scale = photo.image ? width / photo.image.naturalWidth : 1;
  const places = pixels.map(([x, y]) => [x * scale, y * scale]);
  if (places.length) line(pen, places.length === 4 ? [...places, places[0]] : places, "#0072b2", 4);
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
  say("said-photo", words.photo_kept);
  await showPhoto();
});

by("straighten").addEventListener("click", async () => {
  const places = [1, 2, 3, 4].map((k) => by(`point-${k}`).value.split(/[;\s]+|,\s+|,(?=[^,]*$)/).filter(Boolean).map(number));
  if (await ask("straighten", { pixels, places }, "said-photo")) {
    say("said-photo", words.straightened);
    await showStraight();
  }
});

async function showStraight() {
  board.image = await picture("straight.jpg");
  board.paint();
}

// --- front and cracks

let front = null, cracks = [], areas = [], open = [], joints = [];
const wide = () => front.length + 2 * MARGIN, high = () => front.height + 2 * MARGIN;
const placeAt = ([x, y]) => [x * wide() - MARGIN, front.height + MARGIN - y * high()];
const board = new Board(by("front"), (at) => {
  if (!front) return;
  const place = placeAt(at).map((value) => Math.round(value * 1e4) / 1e4);
  const last = open[open.length - 1];
  if (last && last[0] === place[0] && last[1] === place[1]) return;
  open.push(place);
  if (by("tool").value === "area" && open.length === 2) finish();
  where();
}, drawFront);
board.keys = { f: finish, F: finish, Backspace: () => open.pop() };

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
  pen.strokeStyle = board.image ? "rgba(255,255,255,.35)" : "#8a8a8a";
  pen.lineWidth = 1;
  for (const [x, z, length, height] of front.bricks) {
    const [left, top] = at([x - length / 2, z + height / 2]);
    pen.strokeRect(left, top, length * scale, height * scale);
  }
  for (const [x, z, right, top] of areas) {
    const [one, other] = [at([x, z]), at([right, top])];
    pen.fillStyle = "rgba(0,114,178,.15)";
    pen.fillRect(one[0], one[1], other[0] - one[0], other[1] - one[1]);
  }
  for (const [x, z, right, top] of joints) line(pen, [at([x, z]), at([right, top])], "#009e73", 9);
  for (const crack of cracks) line(pen, crack.points.map(at), "#d55e00", 4);
  if (open.length) line(pen, open.map(at), "#0072b2", 4);
  open.forEach((point) => dot(pen, at(point), "#0072b2"));
}

function finish() {
  if (open.length < 2) return;
  if (by("tool").value === "area") {
    areas.push([...open[0], ...open[1]]);
  } else {
    cracks.push({ points: open, width_mm: field("width"), offset: by("offset").value });
  }
  open = [];
  changed();
}

function undo() {
  if (open.length) open.pop();
  else (by("tool").value === "area" ? areas : cracks).pop();
  changed();
}

function changed() {
  joints = [];
  const body = by("drawn").tBodies[0];
  body.replaceChildren();
  const lines = [...cracks.map((one) => [cracks, one]), ...areas.map((one) => [areas, one])];
  for (const [list, one] of lines) {
    const row = body.insertRow(), isCrack = list === cracks;
    const length = isCrack ? one.points.slice(1).reduce((sum, [x, z], k) =>
      sum + Math.hypot(x - one.points[k][0], z - one.points[k][1]), 0) : null;
    cells(row, [words[isCrack ? "crack" : "area"], isCrack ? shown(length, 3) : "", isCrack ? shown(one.width_mm) : "",
      isCrack ? words[one.offset] : ""]);
    const button = document.createElement("button");
    button.textContent = words.delete;
    button.addEventListener("click", () => { list.splice(list.indexOf(one), 1); changed(); });
    row.insertCell().append(button);
  }
  by("drawn").hidden = lines.length === 0;
  board.paint();
}

by("finish").addEventListener("click", finish);
by("undo").addEventListener("click", undo);

const survey = () => ({ cracks, areas: areas.map(([x, z, right, top]) => [[x, z], [right, top]]),
  limit_mm: field("limit"), error_mm: field("error") });

by("put-on-joints").addEventListener("click", async () => {
  finish();
  const found = await ask("survey", survey(), "said-cracks");
  if (!found) return;
  joints = found.joints;
  say("said-cracks", fill("share", { share: shown(100 * found.share_on_joints, 3), length: shown(found.crack_length_m, 3),
    apart: shown(1000 * found.apart_m, 2) }));
  board.paint();
});

function showFront(found) {
  front = found;
  say("said-front", fill("front_is", { name: found.name, length: shown(found.length, 4), height: shown(found.height, 4),
    points: found.contact_points }));
  found.corners.forEach(([x, z], k) => { by(`point-${k + 1}`).value = `${+x.toFixed(4)} ${+z.toFixed(4)}`; });
  board.size(wide(), high());
  board.paint();
}

by("use-front").addEventListener("click", async () => {
  const found = await ask("front", { text: by("front-text").value }, "said-front");
  if (!found) return;
  board.image = null;
  showFront(found);
  changed();
});

// --- address, settlement, runs

by("show-earthquakes").addEventListener("click", async () => {
  const found = await ask("address", { latitude: field("latitude"), longitude: field("longitude") }, "said-address");
  if (!found) return;
  const body = by("earthquakes").tBodies[0];
  body.replaceChildren();
  for (const event of found.events) {
    cells(body.insertRow(), [event.time_utc, shown(event.magnitude), event.place, shown(event.epicentral_km),
      shown(event.median_mm_s, 3), shown(event.one_percent_mm_s, 3)]);
  }
  by("earthquakes").hidden = false;
  say("said-address", "");
  const ends = document.createElement("strong");
  ends.textContent = fill("catalogue_ends", { date: found.catalogue_ends });
  by("said-address").append(ends, ...found.warnings.map((one) => ` ${one}`));
});

by("settle").addEventListener("change", () => {
  const chosen = by("settle").value;
  by("for-levels").hidden = chosen !== "levels";
  by("for-distortion").hidden = chosen === "" || chosen === "levels";
});

by("use-levels").addEventListener("click", async () => {
  const found = await ask("levels", { text: by("levels-text").value }, "said-settlement");
  if (!found) return;
  const most = Math.max(...found.uz_m) - Math.min(...found.uz_m);
  say("said-settlement", [fill("levels_are", { most: shown(1000 * most) }), ...found.notes].join(" "));
});

let timer = null;
function showProgress(found) {
  by("stop").disabled = !found.running;
  by("start").disabled = found.running;
  by("log").hidden = found.lines.length === 0;
  by("log").textContent = found.lines.join("\n");
  by("sheet").hidden = !found.sheet || found.running;
  const key = found.running ? "running" : found.status === null ? null : found.status === 0 ? "done" :
    found.status < 0 || found.status === 130 || found.status === 143 ? "stopped" : "failed";
  if (key) say("said-compute", words[key], key === "failed");
  clearTimeout(timer);
  if (found.running) timer = setTimeout(() => compute("progress"), 1000);
}

async function compute(name, given) {
  const found = await ask(name, given, "said-compute");
  if (found) showProgress(found);
}

by("start").addEventListener("click", () => {
  finish();
  const settle = by("settle").value || null;
  compute("start", { latitude: field("latitude"), longitude: field("longitude"), settle,
    distortion: settle && settle !== "levels" ? 1 / field("distortion") : null, draws: field("draws"),
    language: document.documentElement.lang,
    shown: { front: by("front-text").value, levels: by("levels-text").value, survey: survey() } });
});
by("stop").addEventListener("click", () => compute("stop", {}));

// What is drawn and typed outlives a change of language.
window.addEventListener("pagehide", () => {
  const fields = {};
  for (const one of document.querySelectorAll("input:not([type=file]), select, textarea")) fields[one.id] = one.value;
  sessionStorage.setItem("draft", JSON.stringify({ cracks, areas, fields }));
});

async function begin() {
  const state = await ask("state", undefined, "said-front");
  if (!state) return;
  for (const name of Object.keys(state.fronts)) by("fronts").add(new Option(name, name));
  by("fronts").addEventListener("change", () => { by("front-text").value = state.fronts[by("fronts").value]; });
  by("front-text").value = state.house || state.fronts[by("fronts").value];
  if (state.front) showFront(state.front);
  const kept = JSON.parse(sessionStorage.getItem("draft") || "null");
  for (const [id, value] of Object.entries(kept ? kept.fields : {})) if (by(id)) by(id).value = value;
  const drawn = kept || state.drawn;
  if (drawn) ({ cracks, areas } = drawn);
  if (!kept && drawn) [by("limit").value, by("error").value] = [drawn.limit_mm, drawn.error_mm];
  changed();
  by("settle").dispatchEvent(new Event("change"));
  if (state.photo) await showPhoto();
  if (state.straight) await showStraight();
  showProgress(state);
  document.body.dataset.ready = "yes";
}
begin();
