"use strict";
// The drawings are plotly's; here is what moves them: one time for all, one magnification, and tables that sort.

const byId = (id) => document.getElementById(id);

function bytesOf(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

const TYPES = {f4: Float32Array, i4: Int32Array, i2: Int16Array, u2: Uint16Array, u1: Uint8Array};

async function arraysOf(run) {
  const stream = new Blob([bytesOf(run.packed)]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(stream).arrayBuffer();
  for (const [name, [type, first, length]] of Object.entries(run.arrays))
    run[name] = new TYPES[type](buffer, first, length);
  run.times = Array.from(run.instant, (point) => run.time_s[point]);
}

// --- tables -----------------------------------------------------------------------------------------

function makeSortable(table) {
  const heads = Array.from(table.tHead.rows[0].cells);
  heads.forEach((head, column) => {
    const button = head.querySelector("button");
    if (button) button.addEventListener("click", () => {
      const rising = head.getAttribute("aria-sort") !== "ascending", body = table.tBodies[0];
      for (const other of heads) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
      head.setAttribute("aria-sort", rising ? "ascending" : "descending");
      const key = (row) => row.cells[column].dataset.sort, words = (row) => row.cells[column].textContent;
      const compare = (a, b) => {
        if (key(a) !== undefined && key(b) !== undefined) return (rising ? 1 : -1) * (key(a) - key(b));
        if (key(a) !== undefined || key(b) !== undefined) return key(a) !== undefined ? -1 : 1;  // numbers first
        return (rising ? 1 : -1) * words(a).localeCompare(words(b), "en", {numeric: true});
      };
      body.append(...Array.from(body.rows).sort(compare));
    });
  });
}

// Of a study: marks, lines and rows of the points that its filters leave.
function filter(part) {
  const chosen = Array.from(part.querySelectorAll(".choose select")), rows = part.querySelectorAll("tr[data-of]");
  const show = () => {
    for (const one of part.querySelectorAll("[data-of]")) {
      const of = one.dataset.of.split(" ");
      one.classList.toggle("out", chosen.some((select) => select.value && select.value !== of[select.dataset.place]));
    }
    part.querySelector(".choose output").textContent = `${rows.length - part.querySelectorAll("tr.out").length} of `
      + `${rows.length} points`;
  };
  for (const select of chosen) select.addEventListener("change", show);
}

// --- the wall ---------------------------------------------------------------------------------------

// Where bodies, and behind them the supports, are at instant k, motion magnified: shift, cosine and sine of each.
function places(run, k, magnify) {
  const n = run.x.length + run.support_x.length, found = {x: new Float64Array(n), z: new Float64Array(n),
    cos: new Float64Array(n), sin: new Float64Array(n)};
  for (let body = 0, at = 3 * n * k; body < n; body++, at += 3) {
    const turn = magnify * run.step[2] * run.place[at + 2];
    found.x[body] = magnify * run.step[0] * run.place[at];
    found.z[body] = magnify * run.step[1] * run.place[at + 1];
    found.cos[body] = Math.cos(turn);
    found.sin[body] = Math.sin(turn);
  }
  return found;
}

function moved(run, at, body, x, z) {
  const support = -1 - body, b = body < 0 ? run.x.length + support : body;
  const cx = body < 0 ? run.support_x[support] : run.x[b], cz = body < 0 ? 0 : run.z[b];
  return [cx + at.x[b] + at.cos[b] * (x - cx) - at.sin[b] * (z - cz),
    cz + at.z[b] + at.sin[b] * (x - cx) + at.cos[b] * (z - cz)];
}

// Outlines of bodies of each kind, one line with gaps.
function outlines(run, at, kinds) {
  const lines = kinds.map(() => ({x: [], y: []}));
  for (let b = 0; b < run.x.length; b++) {
    const line = lines[run.kind[b]], l = run.length[b] / 2, h = run.height[b] / 2;
    for (const [dx, dz] of [[-l, -h], [l, -h], [l, h], [-l, h], [-l, -h]]) {
      const [x, z] = moved(run, at, b, run.x[b] + dx, run.z[b] + dz);
      line.x.push(x);
      line.y.push(z);
    }
    line.x.push(null);
    line.y.push(null);
  }
  return lines;
}

// Add joint j of a list to a line with gaps: both ends, each halfway between where the two bodies carry it.
function addJoint(line, run, at, ends, first, second, j) {
  for (const e of [4 * j, 4 * j + 2]) {
    const [ax, az] = moved(run, at, first[j], ends[e], ends[e + 1]);
    const [bx, bz] = moved(run, at, second[j], ends[e], ends[e + 1]);
    line.x.push((ax + bx) / 2);
    line.y.push((az + bz) / 2);
  }
  line.x.push(null);
  line.y.push(null);
}

// The joints that cannot fail, one line with gaps.
function elasticLine(run, at) {
  const line = {x: [], y: []};
  for (let j = 0; j < run.n_elastic; j++)
    addJoint(line, run, at, run.elastic_ends, run.elastic_first, run.elastic_second, j);
  return line;
}

const widthClass = (legend, millimetres) => (
  Math.max(legend.widths.findLastIndex((one) => millimetres >= one.from_mm), 0));

const BROKEN = 1;

// Lines of the joints that are not whole at instant k: broken, by width and state; how many of each state.
function cracks(run, k, at, legend, withWords) {
  const n = run.n_ever, lines = Array.from({length: 1 + legend.widths.length * legend.states.length},
    () => ({x: [], y: [], text: []})), counts = {};
  for (let j = 0; j < n; j++) {
    const state = run.state[n * k + j];
    if (!state) continue;
    counts[state] = (counts[state] || 0) + 1;
    const mm = run.width_um[n * k + j] / 1000;
    const place = legend.states.findIndex((one) => one.code === state);
    const line = state === BROKEN ? lines[0] : lines[1 + widthClass(legend, mm) * legend.states.length + place];
    addJoint(line, run, at, run.ends, run.first, run.second, j);
    if (withWords) {
      const words = `${run.head[j] ? "head" : "bed"} joint ${state === BROKEN ? "broken" : legend.states[place].name}, `
        + `${mm.toFixed(3)} mm wide`;
      line.text.push(words, words, "");
    }
  }
  return {lines, counts};
}

function wallTraces(legend) {
  const line = (colour, width, dash) => ({...LINE, x: [], y: [], connectgaps: false, showlegend: false,
    line: {color: colour, width, dash: dash || "solid", simplify: false}, hoverinfo: "text"});
  const area = ({fill, edge}) => ({...line(edge, 0.6), fill: "toself", fillcolor: fill, hoverinfo: "skip"});
  const {elastic} = legend;
  const traces = [...legend.bodies.map(area),
    {...line(elastic.colour, elastic.pixels, elastic.dash), hoverinfo: "skip"}, line("#777777", 0.9)];
  for (const width of legend.widths) for (const state of legend.states) traces.push(
    line(state.colour, width.pixels, state.dash));
  return traces;
}

function extent(run) {
  let x0 = Infinity, x1 = -Infinity, z1 = -Infinity;
  run.x.forEach((x, b) => {
    x0 = Math.min(x0, x - run.length[b] / 2);
    x1 = Math.max(x1, x + run.length[b] / 2);
    z1 = Math.max(z1, run.z[b] + run.height[b] / 2);
  });
  const margin = 0.06 * Math.max(x1 - x0, z1);
  return {x: [x0 - margin, x1 + margin], y: [-margin / 2, z1 + margin / 2]};
}

// --- plots ------------------------------------------------------------------------------------------

const FONT = {family: "Arial, Liberation Sans, Helvetica, sans-serif", size: 12, color: "#1a1a1a"};
// Named one by one: newer versions have buttons that send the data elsewhere.
const CONFIG = {responsive: true, displaylogo: false,
  modeBarButtons: [["toImage", "zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "resetScale2d"]]};
const LINE = {type: "scatter", mode: "lines"};
const AXIS = {showline: true, linecolor: "#555", ticks: "outside", ticklen: 4, gridcolor: "#e8e8e8",
  zerolinecolor: "#bbb"};
const MARGIN = {l: 62, r: 10, t: 26, b: 42};
const named = (text) => ({text, standoff: 6});

// Range of lists of numbers with some room, what is not finite left out.
function rangeOf(lists, room) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const value of list) if (Number.isFinite(value)) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) [low, high] = [0, 1];
  const more = room * (high - low) || room * (Math.abs(high) || 1);
  return [low - more, high + more];
}

// A mark over a plot, moved without drawing that anew: a line across at x or, where y is given, a ring.  Its place is
// by what plotly left of the plot beside legends, which is wider or narrower with the screen and its font.
class Mark {
  constructor(div, kind) {
    this.div = div;
    this.element = div.appendChild(Object.assign(document.createElement("div"), {className: kind}));
    div.on("plotly_afterplot", () => this.place());
  }

  move(x, y) { [this.x, this.y] = [x, y]; this.place(); }

  place() {
    const {element} = this, {xaxis, yaxis} = this.div.layout, {l, t, w, h} = this.div._fullLayout._size;
    const share = (value, [low, high]) => (value - low) / (high - low);
    const x = share(this.x, xaxis.range), y = this.y === undefined ? 0.5 : share(this.y, yaxis.range);
    element.hidden = !(x >= 0 && x <= 1 && y >= 0 && y <= 1);
    element.style.left = `${l + x * w}px`;
    element.style.top = `${this.y === undefined ? t : t + (1 - y) * h}px`;
    if (this.y === undefined) element.style.height = `${h}px`;
  }
}

function timeMarks(runs) {
  const spans = runs.flatMap((run) => [...run.settling.map((span) => [span, "#e9e9e9"]),
    ...run.settlement.map((span) => [span, "#f3e6c8"])]);
  const shades = spans.map(([[x0, x1], fillcolor]) => (
    {type: "rect", xref: "x", yref: "paper", x0, x1, y0: 0, y1: 1, fillcolor, line: {width: 0}, layer: "below"}));
  const falls = runs.filter((run) => run.collapsed_at_s !== null).map((run) => (
    {type: "line", xref: "x", yref: "paper", x0: run.collapsed_at_s, x1: run.collapsed_at_s, y0: 0, y1: 1,
      line: {color: "#b00000", width: 1, dash: "dash"}}));
  return [...shades, ...falls];
}

// On paper what is cracked is black, thicker, and distinguished by its line alone.
function printable(run, legend, onPaper) {
  const first = legend.bodies.length + 2;
  const lines = legend.widths.flatMap((width) => legend.states.map((state) => (
    onPaper ? {color: "#000000", width: 1.7 * width.pixels} : {color: state.colour, width: width.pixels})));
  Plotly.restyle(byId(`wall-${run.letter}`), {"line.color": lines.map((one) => one.color),
    "line.width": lines.map((one) => one.width)}, lines.map((_, number) => first + number));
}

// As the style of a printed page has it: its width without margins, gaps between columns [px], the size of drawings.
const PRINT = {width: 695, gap: 16, zoom: 0.62};

// Give a drawing the width that it has on paper, a share of the page less gaps, or on screen again that of its place.
function fitWidth(id, onPaper, share, gaps) {
  const width = (share * (PRINT.width - gaps * PRINT.gap)) / PRINT.zoom;
  Plotly.relayout(byId(id), onPaper ? {width} : {width: null, autosize: true});
}

function fitPage(runs, onPaper) {
  const single = runs.length === 1;
  fitWidth("over-time", onPaper, 1, 0);
  for (const {letter} of runs) {
    fitWidth(`wall-${letter}`, onPaper, single ? 0.6 : 0.5, 1);
    for (const kind of ["hysteresis", "energy"]) fitWidth(`${kind}-${letter}`, onPaper, 0.5, 1);
  }
}

function drawInto(id, traces, layout) {
  const div = byId(id);
  div.textContent = "";
  return Plotly.newPlot(div, traces, {font: FONT, margin: MARGIN, hovermode: "closest", ...layout}, CONFIG);
}

function drawWall(run, legend, lines) {
  const box = extent(run);
  const ground = {type: "rect", xref: "paper", yref: "y", x0: 0, x1: 1, y0: box.y[0], y1: 0, fillcolor: "#d9d9d9",
    line: {width: 0}, layer: "below"};
  const axis = {...AXIS, showgrid: false, zeroline: false, constrain: "domain"};
  const traces = wallTraces(legend).map((trace, number) => ({...trace, ...lines[number]}));
  return drawInto(`wall-${run.letter}`, traces, {shapes: [ground], margin: {...MARGIN, l: 48},
    xaxis: {...axis, range: box.x, title: named("x [m]")},
    yaxis: {...axis, range: box.y, title: named("z [m]"), scaleanchor: "x", constraintoward: "bottom"}});
}

const moving = (run, series, factor) => run[series].map((value, point) => (run.settles[point] ? NaN : factor * value));

async function drawHysteresis(run, runs, drift) {
  const ranges = [["drift_ratio", drift.factor], ["base_shear_kn", 1]].map(
    ([series, factor]) => rangeOf(runs.map((one) => moving(one, series, factor)), 0.06));
  await drawInto(`hysteresis-${run.letter}`, [{...LINE, x: moving(run, "drift_ratio", drift.factor),
    y: moving(run, "base_shear_kn", 1), showlegend: false, line: {color: "#0072B2", width: 1}}], {
    xaxis: {...AXIS, range: ranges[0], title: named(`drift ratio [${drift.unit}]`)},
    yaxis: {...AXIS, range: ranges[1], title: named("base shear [kN]")}});
  run.ring = new Mark(byId(`hysteresis-${run.letter}`), "ring");
}

async function drawEnergy(run, runs, lines) {
  const traces = lines.map((line) => ({...LINE, x: run.time_s, y: run[line.series], name: line.name,
    line: {color: line.colour, dash: line.dash, width: line.series === "input_energy_j" ? 2 : 1.3}}));
  const across = rangeOf(runs.map((one) => one.time_s), 0);
  const up = rangeOf(runs.flatMap((one) => lines.map((line) => one[line.series])), 0.05);
  await drawInto(`energy-${run.letter}`, traces, {shapes: timeMarks([run]), margin: {...MARGIN, r: 92},
    legend: {x: 1.01, font: {size: 11}}, xaxis: {...AXIS, range: across, title: named("time [s]")},
    yaxis: {...AXIS, range: up, title: named("energy [J]")}});
  run.cursor = new Mark(byId(`energy-${run.letter}`), "cursor");
}

async function drawOverTime(runs, panels) {
  const traces = [], n = panels.length, gap = 0.05, tall = (1 - gap * (n - 1)) / n;
  const layout = {height: 114 + 150 * n, margin: {...MARGIN, l: 80, t: 70}, hovermode: "x", shapes: timeMarks(runs),
    legend: {orientation: "h", y: 1.005, yanchor: "bottom", x: 0, itemwidth: 50},
    xaxis: {...AXIS, range: rangeOf(runs.map((run) => run.time_s), 0), title: named("time [s]"),
      anchor: n > 1 ? `y${n}` : "y"}};
  panels.forEach((panel, number) => {
    const several = runs.length > 1, top = 1 - number * (tall + gap), lists = [];
    for (const line of panel.lines) {
      const y = runs[line.run][line.series].map((value) => panel.factor * value);
      lists.push(y);
      traces.push({...LINE, x: runs[line.run].time_s, y, yaxis: number ? `y${number + 1}` : "y",
        name: line.name, legendgroup: several ? line.name : "",
        showlegend: several ? number === 0 : panel.lines.length > 1,
        line: {color: line.colour, dash: line.dash, width: line.series === "DI" ? 2 : 1.4}});
    }
    layout[`yaxis${number ? number + 1 : ""}`] = {...AXIS, domain: [Math.max(top - tall, 0), top],
      range: rangeOf(lists, 0.06), title: named(panel.unit ? `${panel.title}<br>[${panel.unit}]` : panel.title)};
  });
  byId("over-time").style.height = `${layout.height}px`;
  await drawInto("over-time", traces, layout);
  return new Mark(byId("over-time"), "cursor");
}

function drawLegend(legend, withElastic) {
  const sample = (colour, width, dash) => '<svg width="46" height="14" aria-hidden="true">'
    + `<line x1="2" y1="7" x2="44" y2="7" stroke="${colour}" stroke-width="${width}" `
    + `stroke-dasharray="${dash === "solid" ? "none" : dash}"/></svg>`;
  const middle = legend.widths[2].pixels;
  const parts = legend.states.map((state) => `<span>${sample(state.colour, middle, state.dash)}${state.name}</span>`);
  const {elastic} = legend;
  if (withElastic) parts.push(`<span>${sample(elastic.colour, 2 * elastic.pixels, elastic.dash)}${elastic.name}</span>`);
  parts.push(`<span>${sample("#777", 0.8, "solid")}broken, up to ${legend.widths[0].from_mm} mm</span>`);
  parts.push(...legend.widths.map((one) => (
    `<span>${sample("#444", one.pixels, "solid")}from ${one.from_mm} mm</span>`)));
  byId("legend").innerHTML = parts.join("");
}

// --- one time for all -------------------------------------------------------------------------------

const MAGNIFICATIONS = [0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];

const lastUpTo = (times, time) => Math.max(times.findLastIndex((one) => one <= time), 0);

class Player {
  constructor(page) {
    this.page = page;
    this.times = Array.from(new Set(page.runs.flatMap((run) => run.times))).sort((a, b) => a - b);
    this.at = lastUpTo(this.times, page.runs[0].at_max + 1e-6);
    this.playing = false;
    const wanted = Math.min(...page.runs.map((run) => run.magnify));
    this.magnification = Math.max(MAGNIFICATIONS.findLastIndex((one) => one <= wanted), 1);
    this.slider = byId("time-slider");
    this.slider.max = this.times.length - 1;
    this.slider.addEventListener("input", () => { this.stop(); this.go(+this.slider.value); });
    const magnify = byId("magnify");
    magnify.max = MAGNIFICATIONS.length - 1;
    magnify.value = this.magnification;
    magnify.addEventListener("input", () => { this.magnification = +magnify.value; this.show(); });
    byId("play").addEventListener("click", () => (this.playing ? this.stop() : this.play()));
    byId("to-max").addEventListener("click", () => { this.stop(); this.goTo(page.runs[0].at_max + 1e-6); });
    byId("to-end").addEventListener("click", () => { this.stop(); this.go(this.times.length - 1); });
    byId("player").hidden = false;
  }

  go(number) { this.at = number; this.show(); }
  goTo(time) { this.go(lastUpTo(this.times, time)); }

  play() {
    this.playing = true;
    this.label("\u275A\u275A", "Pause");
    if (this.at === this.times.length - 1) this.at = 0;
    this.from = {clock: performance.now(), time: this.times[this.at]};
    byId("speed").onchange = () => { this.from = {clock: performance.now(), time: this.times[this.at]}; };
    const step = () => {
      if (!this.playing) return;
      const time = this.from.time + (performance.now() - this.from.clock) / 1000 * byId("speed").value;
      const next = lastUpTo(this.times, time);
      if (next !== this.at) this.go(next);
      if (next === this.times.length - 1) this.stop(); else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  stop() {
    if (!this.playing) return;
    this.playing = false;
    this.label("\u25B6", "Play");
    this.show();
  }

  label(sign, word) {
    byId("play").innerHTML = `<span aria-hidden="true">${sign}</span> ${word}`;
    byId("play").setAttribute("aria-pressed", this.playing);
  }

  show() {
    const time = this.times[this.at], content = `${time.toFixed(3)} s`;
    this.slider.value = this.at;
    this.slider.setAttribute("aria-valuetext", content);
    byId("time-shown").textContent = content;
    byId("magnify-shown").textContent = `× ${MAGNIFICATIONS[this.magnification]}`;
    byId("magnify").setAttribute("aria-valuetext", `${MAGNIFICATIONS[this.magnification]} times`);
    for (const run of this.page.runs) this.showWall(run);
    if (this.ready) this.showTime(time);
  }

  // What is drawn of a wall now, and how many of its contact points are in each state.
  linesOf(run) {
    const k = lastUpTo(run.times, this.times[this.at]), at = places(run, k, MAGNIFICATIONS[this.magnification]);
    const {lines, counts} = cracks(run, k, at, this.page.states, !this.playing);
    return {k, counts, lines: [...outlines(run, at, this.page.states.bodies), elasticLine(run, at), ...lines]};
  }

  showWall(run) {
    const {k, counts, lines} = this.linesOf(run);
    Plotly.restyle(byId(`wall-${run.letter}`), {x: lines.map((one) => one.x), y: lines.map((one) => one.y),
      text: lines.map((one) => one.text || [])});
    byId(`shown-${run.letter}`).textContent = this.inWords(run, k, counts);
    run.shown = k;
  }

  inWords(run, k, counts) {
    const {drift, states, threshold_mm} = this.page, point = run.instant[k];
    const value = (name, digits) => run[name][point].toFixed(digits);
    const over = this.times[this.at] > run.times[run.times.length - 1] ? ", its end" : "";
    const content = states.states.map((one) => `${counts[one.code] || 0} ${one.name}`).join(", ");
    return `${run.times[k].toFixed(3)} s${over}: DI ${value("DI", 3)} (drift ${value("DI_drift", 3)}, open `
      + `${value("DI_open", 3)}, slip ${value("DI_slip", 3)}); `
      + `drift ${(drift.factor * run.drift_ratio[point]).toPrecision(3)} ${drift.unit}, base shear `
      + `${value("base_shear_kn", 2)} kN. Contact points: ${content}, ${counts[BROKEN] || 0} broken up to `
      + `${threshold_mm} mm, of ${run.n_joints}. Displacements × ${MAGNIFICATIONS[this.magnification]}`
      + (run.snapshot[k] ? "." : ", but no place of the bricks was written near this time.");
  }

  showTime(time) {
    this.cursor.move(time);
    for (const run of this.page.runs) {
      const point = run.instant[run.shown];
      run.cursor.move(time);
      run.ring.move(this.page.drift.factor * run.drift_ratio[point], run.base_shear_kn[point]);
    }
  }
}

const nextFrame = () => new Promise((done) => setTimeout(done));

async function start() {
  const page = JSON.parse(byId("report-data").textContent);
  if (typeof DecompressionStream === "undefined") throw new Error("this browser is too old for the drawings: Chrome or "
    + "Edge 80, Firefox 113, Safari 16.4 or later draws them");
  await Promise.all(page.runs.map(arraysOf));
  page.drift = page.charts.find((panel) => panel.lines[0].series === "drift_ratio");
  drawLegend(page.states, page.runs.some((run) => run.n_elastic > 0));
  const player = new Player(page);
  await Promise.all(page.runs.map((run) => drawWall(run, page.states, player.linesOf(run).lines)));
  performance.mark("wall-drawn");
  player.show();
  await nextFrame();
  player.cursor = await drawOverTime(page.runs, page.charts);
  for (const run of page.runs) {
    await nextFrame();
    await drawHysteresis(run, page.runs, page.drift);
    await drawEnergy(run, page.runs, page.states.energies);
  }
  player.ready = true;
  player.show();
  for (const id of ["over-time", ...page.runs.map((run) => `energy-${run.letter}`)])
    byId(id).on("plotly_click", (event) => { player.stop(); player.goTo(event.points[0].x + 1e-6); });
  for (const [event, onPaper] of [["beforeprint", true], ["afterprint", false]])
    addEventListener(event, () => {
      page.runs.forEach((run) => printable(run, page.states, onPaper));
      fitPage(page.runs, onPaper);
    });
  document.documentElement.classList.add("drawn");
  window.report = player;
  performance.mark("all-drawn");
}

document.querySelectorAll("table.sortable").forEach(makeSortable);
document.querySelectorAll("section:has(.choose)").forEach(filter);
if (byId("report-data")) start().catch((error) => {
  byId("failed").hidden = false;
  byId("failed").textContent = `The drawings failed: ${error.message}. The tables below are whole.`;
  console.error(error);
});
