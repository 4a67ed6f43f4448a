// Fills the page from the data within it.
"use strict";
function table(parent, head, rows) {
  const wrap = element(parent, "div", { class: "scroll" }), box = element(wrap, "table");
  if (head.length) { const row = element(box, "tr"); head.forEach((name) => element(row, "th", {}, name)); }
  for (const cells of rows) {
    const row = element(box, "tr");
    cells.forEach((cell) => element(row, "td", typeof cell === "number" ? { class: "number" } : {}, typeof cell === "number" ? figure(cell) : cell));
  }
  return box;
}

function header() {
  const run = data.run, end = data.end;
  byId("title").textContent = document.title = run.title || run.scene || "Log";
  const how = data.ending !== "complete" ? data.ending : end ? `ended "${end.reason}"` : data.recovered ? "recovered from a log that was cut" : "cut short";
  byId("subtitle").textContent = `${run.scene || "?"}, sandgate ${run.version || "?"}, seed ${run.seed || "?"}, ${how}`;
}

function tiles() {
  const last = data.time.length - 1, stats = data.stats;
  const tile = (value, name, kind = "") => { const box = element(byId("figures"), "div", { class: "tile" }); element(box, "b", { class: kind }, value); element(box, "span", {}, name); };
  tile(last < 0 ? "–" : `${figure(data.time[last])} s`, "simulated time");
  tile(String(data.step[last] ?? 0), "communication steps");
  tile(figure(stats.total_substeps[last] ?? null), "internal steps");
  tile(figure(stats.particles[last] ?? null), "particles at the end");
  tile(`${figure(Math.max(0, ...stats.max_speed.filter((v) => v !== null)))} m/s`, "largest speed");
  const exact = data.mass_error === 0;
  tile(exact ? "exact" : `${figure(data.mass_error)} kg off`, "account of mass, every step", exact ? "good" : "bad");
  tile(`${figure(100 * Math.max(0, ...stats.share_dilute.filter((v) => v !== null)))} %`, "dilute (I > 0.3), at most");
  if (data.wall_seconds !== null) tile(`${figure(data.wall_seconds)} s`, "wall clock");
}

// One chart for what belongs to a device and has one unit; flags stand with the validity figures.
function devices() {
  const groups = new Map();
  for (const column of data.columns) {
    const [kind, device] = column.name.split(".");
    if (!["gauge", "gate", "inflow", "outflow", "wall"].includes(kind) || column.flag) continue;
    const key = `${kind}.${device} ${column.unit}`;
    if (!groups.has(key)) groups.set(key, { title: `${kind}.${device}`, unit: column.unit, series: [] });
    groups.get(key).series.push({ name: column.name.slice(`${kind}.${device}.`.length) + (column.input ? " (input)" : ""), values: column.values, held: column.input });
  }
  const box = document.querySelector("#devices .charts");
  for (const group of groups.values()) {
    const single = group.series.length === 1;
    chart(box, single ? `${group.title}.${group.series[0].name}` : group.title, group.unit,
      single ? [{ ...group.series[0], name: `${group.title}.${group.series[0].name}` }] : group.series);
  }
}

function mass() {
  const box = document.querySelector("#mass .charts"), { initial, inflow, outflow, present } = data.stats;
  chart(box, "Mass present", "kg", [{ name: "Mass present", values: present }]);
  chart(box, "Mass that came and went", "kg", [{ name: "in", values: inflow }, { name: "out", values: outflow }]);
  const k = present.length - 1;
  if (k < 0) return;
  table(byId("ledger"), ["", "kg"], [["at the start", String(initial[k])], ["+ in", String(inflow[k])], ["− out", String(outflow[k])], ["= present", String(present[k])]]);
  element(byId("ledger"), "p", { class: data.mass_error === 0 ? "good" : "bad" }, data.mass_error === 0
    ? `initial + in − out = present to the last bit on all ${data.lines_checked} lines of the log.`
    : `The account is off by ${data.mass_error} kg on a line of the log.`);
}

function solver() {
  const box = document.querySelector("#solver .charts"), s = data.stats;
  chart(box, "Internal step", "s", [{ name: "last", values: s.step_size }, { name: "smallest", values: s.smallest_step }]);
  chart(box, "Internal steps a communication step", "1", [{ name: "Internal steps a communication step", values: s.substeps }]);
  chart(box, "Iterations a communication step", "1", [{ name: "Iterations a communication step", values: s.iterations }]);
  chart(box, "Particles", "1", [{ name: "Particles", values: s.particles }]);
  chart(box, "Kinetic energy", "J", [{ name: "Kinetic energy", values: s.kinetic_energy }]);
  chart(box, "Largest speed", "m/s", [{ name: "Largest speed", values: s.max_speed }]);
  const all = Object.values(data.bound_by).reduce((a, b) => a + b, 0);
  if (all > 0) table(byId("bounds"), ["smallest internal step bound by", "communication steps", "share"],
    Object.entries(data.bound_by).map(([name, count]) => [name, count, `${figure(100 * count / all)} %`]));
}

// Shares over time, and a strip each flag: when could a gauge not measure, when was a gate blocked.
function validity() {
  const box = document.querySelector("#validity .charts");
  for (const [name, text] of [["stats.share_dilute", "Share of mass outside the dense regime (I > 0.3)"], ["stats.share_ill_posed", "Share of mass that yields where its law is ill-posed"], ["stats.creep_rate", "Shear rate of material below its strength"], ["stats.share_fast", "Share of mass faster than a fifth of the sound speed"], ["stats.share_squeezed", "Share of mass squeezed by more than a twentieth"]]) {
    const column = data.columns.find((c) => c.name.endsWith(name.slice(6)));
    if (column) chart(box, text, column.unit, [{ name: text, values: column.values }]);
  }
  const words = ["valid", "empty", "outside", "blocked"], strips = [];
  for (const column of data.columns.filter((c) => c.flag)) {
    const validity = column.name.endsWith(".validity");
    const counts = new Map();
    column.values.forEach((v) => { const word = validity ? words[v] ?? "?" : v ? "yes" : "no"; counts.set(word, (counts.get(word) || 0) + 1); });
    strips.push([column, validity, counts]);
  }
  if (strips.length === 0) return;
  element(byId("flags"), "p", { class: "quiet" }, "Grey: all is well; coloured: a gauge could not measure, or a gate or inflow was blocked.");
  const grid = element(byId("flags"), "div", { class: "strip" });
  for (const [column, , counts] of strips) {
    element(grid, "span", {}, `${column.name}: ${[...counts].map(([word, n]) => counts.size > 1 ? `${word} ${figure(100 * n / column.values.length)} %` : word).join(", ")}`);
    const strip = element(grid, "canvas", { width: Math.max(column.values.length, 1), height: 1 }), pen = strip.getContext("2d");
    column.values.forEach((v, i) => { if (v) { pen.fillStyle = ["", "#a16207", "#7c3aed", "#c2410c"][v] || "#c2410c"; pen.fillRect(i, 0, 1, 1); } });
  }
}

function record() {
  if (data.lines.length) {
    table(byId("lines"), ["t [s]", "", "from", "line"], data.lines.map((l) => [figure(l.time), l.level, l.name, l.message]));
    if (data.lines_left_out) element(byId("lines"), "p", { class: "quiet" }, `${data.lines_left_out} more lines are in the log.`);
  }
  const rows = [["file", data.file], ["ending", data.ending], ...Object.entries(data.run)];
  if (data.end) rows.push(...Object.entries(data.end).map(([k, v]) => [`end: ${k}`, v]));
  table(byId("run"), [], rows);
  table(byId("channels"), ["topic", "messages", "message"], data.channels.map((c) => [c.topic, c.messages, c.schema]));
}

function theme() {
  const root = document.documentElement, dark = matchMedia("(prefers-color-scheme: dark)");
  byId("theme").addEventListener("click", () => {
    const now = root.dataset.theme || (dark.matches ? "dark" : "light");
    root.dataset.theme = now === "dark" ? "light" : "dark";
    draw();
  });
  dark.addEventListener("change", () => draw());
}

header();
tiles();
devices();
mass();
solver();
validity();
record();
theme();
startPlayer();
