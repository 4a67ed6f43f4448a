// Lines over time: one unit a chart, a cursor at the player's time, values under the pointer.
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 400, HEIGHT = 190, LEFT = 54, RIGHT = 8, TOP = 8, BOTTOM = 34;
const charts = [];

function element(parent, name, attributes = {}, text = "") {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== "") node.textContent = text;
  parent.append(node);
  return node;
}

function drawn(parent, name, attributes, text = "") {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== "") node.textContent = text;
  parent.append(node);
  return node;
}

// Four digits, and powers of ten only where they save something.
function figure(value) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(2).replace("e+", "e").replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(4)));
}

// Round numbers that span the values, three at least: with fewer nobody can read a scale.
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const sizes = [0.5, 1, 2, 5, 10].map((k) => k * power), many = (s) => Math.floor(high / s + 1e-9) - Math.ceil(low / s - 1e-9) + 1;
  let size = sizes.findIndex((s) => s >= rough * 0.999);
  while (size > 0 && many(sizes[size]) < 3) size -= 1;
  const step = sizes[size] || rough;
  const first = Math.ceil(low / step - 1e-9), steps = Math.floor(high / step + 1e-9) - first;
  // Counted from 0, as k + 1 may be k where numbers are large; the bound is never reached by a span of round numbers.
  const list = [];
  for (let k = 0; k <= Math.min(steps, 4 * count); k++) list.push(Number(((first + k) * step).toPrecision(12)));
  return list;
}

// As many digits as tell one tick from the next.
function label(value, list) {
  const step = (list.length > 1 && list[1] - list[0]) || Math.abs(value) || 1;
  const size = Math.max(...list.map(Math.abs));
  if (value === 0) return "0";
  if (size >= 1e5 || size < 1e-3) return value.toExponential(Math.max(0, Math.floor(Math.log10(Math.abs(value)) + 1e-9) - Math.floor(Math.log10(step) + 1e-9))).replace("e+", "e");
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
}

function span(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const value of list) {
    if (value === null) continue;
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (low > high) return [0, 1];
  // Equal but for rounding, and ticks have twelve digits: there is nothing to see between them.
  if (high - low <= 1e-10 * Math.max(Math.abs(low), Math.abs(high))) { const pad = Math.abs(low) * 0.1 || 1; return [low === 0 ? 0 : low - pad, high + pad]; }
  // From zero if that wastes less than a third.
  if (low > 0 && low < (high - low) / 2) low = 0;
  const pad = (high - low) * 0.04;
  return [low === 0 ? 0 : low - pad, high + pad];
}

// A chart of series {name, values} that share a unit; what is held over a step, as inputs are, is drawn from the step's start.
function chart(parent, title, unit, series, note = "") {
  const box = element(parent, "div", { class: "chart" });
  element(box, "h3", {}, title);
  const keys = element(box, "div", { class: "keys" });
  const many = series.length > 6;
  const colour = (k) => many ? `color-mix(in oklab, var(--s0), var(--s1) ${Math.round(100 * k / (series.length - 1))}%)` : `var(--s${k})`;
  if (many) keys.textContent = `${series.length} values: ${series[0].name} (blue) to ${series[series.length - 1].name} (orange)`;
  else if (series.length > 1 || series[0].name !== title) series.forEach((s, k) => {
    element(keys, "i", { style: `background: ${colour(k)}` });
    keys.append(s.name);
  });
  if (note) keys.append(" " + note);
  const svg = drawn(box, "svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": `${title} over time` });
  const times = data.time, from = times[0], to = times[times.length - 1] > from ? times[times.length - 1] : from + 1;
  const [low, high] = span(series.map((s) => s.values));
  const x = (t) => LEFT + (WIDTH - LEFT - RIGHT) * (t - from) / (to - from);
  const y = (v) => HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (v - low) / (high - low);
  const levels = ticks(low, high, 4), moments = ticks(from, to, 5);
  for (const v of levels) {
    drawn(svg, "line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y(v), y2: y(v) });
    drawn(svg, "text", { x: LEFT - 6, y: y(v) + 4, "text-anchor": "end" }, label(v, levels));
  }
  for (const t of moments) drawn(svg, "text", { x: x(t), y: HEIGHT - BOTTOM + 14, "text-anchor": "middle" }, label(t, moments));
  drawn(svg, "line", { class: "axis", x1: LEFT, x2: WIDTH - RIGHT, y1: HEIGHT - BOTTOM, y2: HEIGHT - BOTTOM });
  drawn(svg, "text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 4, "text-anchor": "middle" }, "time [s]");
  const middle = (TOP + HEIGHT - BOTTOM) / 2;
  drawn(svg, "text", { x: 10, y: middle, "text-anchor": "middle", transform: `rotate(-90 10 ${middle})` }, `[${unit || "1"}]`);
  series.forEach((s, k) => {
    let path = "", pen = "M";
    s.values.forEach((v, i) => {
      if (v === null) { pen = "M"; return; }
      const from = s.held && i > 0 ? `${pen}${x(times[i - 1]).toFixed(2)} ${y(v).toFixed(2)}L` : pen;
      path += `${from}${x(times[i]).toFixed(2)} ${y(v).toFixed(2)}`;
      pen = "L";
    });
    drawn(svg, "path", { class: "curve", d: path, style: `stroke: ${colour(k)}`, "vector-effect": "non-scaling-stroke" });
  });
  const now = drawn(svg, "line", { class: "now", y1: TOP, y2: HEIGHT - BOTTOM, x1: LEFT, x2: LEFT });
  const hover = drawn(svg, "line", { class: "hover", y1: TOP, y2: HEIGHT - BOTTOM, x1: -9, x2: -9, visibility: "hidden" });
  svg.addEventListener("pointermove", (event) => {
    const bounds = svg.getBoundingClientRect();
    const t = from + (to - from) * ((event.clientX - bounds.left) / bounds.width * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
    const i = nearest(times, t);
    hover.setAttribute("x1", x(times[i])); hover.setAttribute("x2", x(times[i])); hover.setAttribute("visibility", "visible");
    const shown = many ? [series[0], series[series.length - 1]] : series;
    tip(event, [`t = ${figure(times[i])} s`, ...shown.map((s) => `${s.name}: ${figure(s.values[i])} ${unit}`)]);
  });
  svg.addEventListener("pointerleave", () => { hover.setAttribute("visibility", "hidden"); byId("tip").hidden = true; });
  svg.addEventListener("click", (event) => {
    const bounds = svg.getBoundingClientRect();
    goTo(from + (to - from) * ((event.clientX - bounds.left) / bounds.width * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT));
  });
  charts.push((t) => { const at = x(Math.min(Math.max(t, from), to)); now.setAttribute("x1", at); now.setAttribute("x2", at); });
}

function nearest(times, t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) { const middle = (low + high) >> 1; if (times[middle] < t) low = middle; else high = middle; }
  return high > low && t - times[low] > times[high] - t ? high : low;
}

function tip(event, lines) {
  const box = byId("tip");
  box.hidden = false;
  box.replaceChildren(...lines.map((line) => Object.assign(document.createElement("div"), { textContent: line })));
  const left = Math.min(event.clientX + 14, innerWidth - box.offsetWidth - 8);
  box.style.left = `${left}px`;
  box.style.top = `${Math.max(8, event.clientY - box.offsetHeight - 10)}px`;
}
