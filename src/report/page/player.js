// Particles, walls and gates at one time: a slider, colours, and in three dimensions a view that turns with the pointer.
"use strict";
const view = byId("view"), brush = view.getContext("2d");
const frames = data.snapshots;
let shown = 0, playing = null, turn = { yaw: -0.6, pitch: 0.35 }, unpacked = { index: -1 };

// Snapshots travel as 16-bit numbers: x y z, speed, pressure, inertial number (by its root), then phase and asleep.
function particles(index) {
  if (unpacked.index === index) return unpacked;
  const bytes = Uint8Array.from(atob(frames[index].data), (c) => c.charCodeAt(0));
  const count = frames[index].count, words = new DataView(bytes.buffer);
  const column = (k) => Float32Array.from({ length: count }, (_, i) => words.getUint16(2 * (k * count + i), true) / 65535);
  const { lower, upper, speed, pressure, inertial } = data.scale;
  const axis = (k) => column(k).map((v) => lower[k] + v * (upper[k] - lower[k]));
  const flags = bytes.subarray(12 * count);
  unpacked = {
    index, count, x: axis(0), y: axis(1), z: axis(2),
    speed: column(3).map((v) => v * speed), pressure: column(4).map((v) => v * pressure),
    inertial: column(5).map((v) => v * v * inertial),
    phase: flags.subarray(0, count), asleep: flags.subarray(count, 2 * count),
  };
  return unpacked;
}

// Viridis at nine points (S. van der Walt, N. Smith, CC0).
const RAMP = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
function ramp(share) {
  const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1), k = Math.min(Math.floor(at), RAMP.length - 2), f = at - k;
  return RAMP[k].map((c, i) => Math.round(c + f * (RAMP[k + 1][i] - c)));
}
const STEPS = Array.from({ length: 256 }, (_, i) => `rgb(${ramp(i / 255).join(",")})`);
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// Each way to colour: from a snapshot to a number from 0 to 1, or to a kind.
const COLOURS = {
  speed: { name: "speed", unit: "m/s", top: data.scale.speed, of: (p, i) => p.speed[i] / (data.scale.speed || 1) },
  pressure: { name: "pressure", unit: "Pa", top: data.scale.pressure, of: (p, i) => p.pressure[i] / (data.scale.pressure || 1) },
  inertial: { name: "inertial number", unit: "1", top: data.scale.inertial, root: true, of: (p, i) => Math.sqrt(p.inertial[i] / (data.scale.inertial || 1)) },
  asleep: { name: "asleep", kinds: ["awake", "asleep"], of: (p, i) => p.asleep[i] },
};
if (data.materials.length > 1) COLOURS.phase = { name: "material", kinds: data.materials, of: (p, i) => p.phase[i] };

function rotated(v, q) {
  const [x, y, z, w] = q, [a, b, c] = v;
  const u = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * u[0] + y * u[2] - z * u[1], b + w * u[1] + z * u[0] - x * u[2], c + w * u[2] + x * u[1] - y * u[0]];
}
function placed(v, pose) {
  if (!pose) return v;
  const turned = rotated(v, pose.slice(3));
  return [turned[0] + pose[0], turned[1] + pose[1], turned[2] + pose[2]];
}

// From the world to the picture: right, up and depth; planar scenes as they are.
function projection() {
  const { lower, upper } = data.scale;
  const centre = [0, 1, 2].map((k) => (lower[k] + upper[k]) / 2);
  if (data.planar) return (x, y) => [x - centre[0], y - centre[1], 0];
  const [cy, sy, cp, sp] = [Math.cos(turn.yaw), Math.sin(turn.yaw), Math.cos(turn.pitch), Math.sin(turn.pitch)];
  return (x, y, z) => {
    const [a, b, c] = [x - centre[0], y - centre[1], z - centre[2]];
    const right = cy * a + sy * b, away = -sy * a + cy * b;
    return [right, cp * c + sp * away, cp * away - sp * c];
  };
}

function draw() {
  const ratio = devicePixelRatio || 1, width = view.clientWidth;
  const { lower, upper } = data.scale, size = [0, 1, 2].map((k) => upper[k] - lower[k]);
  const wide = data.planar ? size[0] : Math.hypot(size[0], size[1]), high = data.planar ? size[1] : Math.hypot(size[2], 0.5 * size[0], 0.5 * size[1]);
  const height = Math.round(Math.min(Math.max(width * high / wide, 220), innerHeight * 0.62));
  view.style.height = `${height}px`;
  view.width = width * ratio; view.height = height * ratio;
  const margin = 34, scale = Math.min((width - 2 * margin) / wide, (height - 2 * margin) / high);
  brush.setTransform(ratio, 0, 0, ratio, 0, 0);
  brush.clearRect(0, 0, width, height);
  const project = projection();
  const at = (x, y, z) => { const [a, b, c] = project(x, y, z); return [width / 2 + a * scale, height / 2 - b * scale, c]; };
  if (frames.length === 0) { solids(at, {}); ruler(scale, width, height); return; }
  const p = particles(shown), colour = COLOURS[byId("colour").value];
  const dot = Math.max(1.2, data.spacing * scale);
  const order = Array.from({ length: p.count }, (_, i) => i);
  const spots = order.map((i) => at(p.x[i], p.y[i], p.z[i]));
  if (!data.planar) order.sort((a, b) => spots[b][2] - spots[a][2]);
  const kinds = (colour.kinds || []).map((_, k) => css(k === 0 ? "--s0" : `--s${k % 6}`));
  for (const i of order) {
    const value = colour.of(p, i);
    brush.fillStyle = colour.kinds ? kinds[value] || kinds[0] : STEPS[Math.round(255 * Math.min(Math.max(value, 0), 1))];
    brush.beginPath();
    brush.arc(spots[i][0], spots[i][1], dot / 2, 0, 2 * Math.PI);
    brush.fill();
  }
  solids(at, frames[shown].frames);
  ruler(scale, width, height);
}

// Walls, gates, inflows, outflows and gauges.
function solids(at, poses) {
  const style = { wall: ["--wall", 2.5], gate: ["--gate", 3], inflow: ["--flow", 2.5], outflow: ["--flow", 1], gauge: ["--gauge", 1] };
  for (const solid of data.solids) {
    if (solid.kind === "gauge" && !byId("gauges").checked) continue;
    const [name, thick] = style[solid.kind] || style.gauge, pose = poses[solid.frame];
    brush.strokeStyle = brush.fillStyle = css(name);
    brush.lineWidth = thick;
    brush.lineJoin = "round";
    brush.setLineDash(solid.kind === "gauge" || solid.kind === "outflow" ? [5, 4] : []);
    for (const line of solid.lines) {
      brush.beginPath();
      line.forEach((point, k) => { const [x, y] = at(...placed(point, pose)); if (k) brush.lineTo(x, y); else brush.moveTo(x, y); });
      brush.stroke();
    }
    for (const box of solid.boxes) {
      const corner = (k) => at(...placed(placed([k & 1 ? box.size[0] / 2 : -box.size[0] / 2, k & 2 ? box.size[1] / 2 : -box.size[1] / 2, k & 4 ? box.size[2] / 2 : -box.size[2] / 2], box.pose), pose));
      const faces = data.planar ? [[0, 1, 3, 2]] : [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
      for (const face of faces) {
        brush.beginPath();
        face.forEach((k, n) => { const [x, y] = corner(k); if (n) brush.lineTo(x, y); else brush.moveTo(x, y); });
        brush.closePath();
        if (solid.kind === "gate" || solid.kind === "wall") { brush.globalAlpha = data.planar ? 0.9 : 0.12; brush.fill(); brush.globalAlpha = 1; }
        brush.stroke();
      }
    }
    if (solid.label) {
      const [x, y] = at(...solid.label);
      brush.font = "12px system-ui, sans-serif";
      brush.setLineDash([]);
      brush.lineWidth = 3.5;
      brush.strokeStyle = css("--empty");
      brush.strokeText(solid.id.replace("gauge.", ""), x + 4, y - 4);
      brush.fillText(solid.id.replace("gauge.", ""), x + 4, y - 4);
    }
  }
  brush.setLineDash([]);
}

// A length to compare with.
function ruler(scale, width, height) {
  const most = 110 / scale, power = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].map((k) => k * power).find((l) => l <= most), pixels = length * scale;
  brush.strokeStyle = brush.fillStyle = css("--quiet");
  brush.lineWidth = 1.5;
  brush.beginPath();
  brush.moveTo(14, height - 18); brush.lineTo(14, height - 13); brush.lineTo(14 + pixels, height - 13); brush.lineTo(14 + pixels, height - 18);
  brush.stroke();
  brush.font = "11px system-ui, sans-serif";
  brush.fillText(length < 0.1 ? `${figure(length * 1000)} mm` : `${figure(length)} m`, 20, height - 18);
}

function legend() {
  const box = byId("legend"), colour = COLOURS[byId("colour").value];
  box.replaceChildren();
  if (colour.kinds) {
    colour.kinds.forEach((kind, k) => { const item = element(box, "span"); element(item, "i", { style: `background: var(--s${k % 6})` }); item.append(kind); });
  } else {
    element(box, "span", {}, `${colour.name} [${colour.unit}]  0`);
    const stops = RAMP.map((c) => `rgb(${c.join(",")})`).join(", ");
    element(box, "span", { class: "ramp", style: `background: linear-gradient(90deg, ${stops})` });
    element(box, "span", {}, figure(colour.top) + (colour.root ? " (by its root: the middle is a quarter of it)" : ""));
  }
  for (const [kind, name] of [["gate", "--gate"], ["inflow", "--flow"], ["outflow", "--flow"], ["gauge", "--gauge"]]) {
    if (!data.solids.some((solid) => solid.kind === kind)) continue;
    const item = element(box, "span");
    element(item, "i", { style: `background: var(${name})` });
    item.append(kind);
  }
}

function show(index) {
  shown = index;
  byId("slider").value = index;
  const t = frames.length ? frames[index].time : data.time[0] || 0;
  byId("when").textContent = `t = ${t.toFixed(3)} s`;
  draw();
  charts.forEach((move) => move(t));
}

function goTo(t) {
  if (frames.length === 0) return;
  show(nearest(frames.map((frame) => frame.time), t));
}

function play() {
  if (playing) { cancelAnimationFrame(playing); playing = null; byId("play").textContent = "Play"; return; }
  if (frames.length < 2) return;
  if (shown === frames.length - 1) show(0);
  let before = performance.now(), t = frames[shown].time;
  byId("play").textContent = "Pause";
  const tick = (now) => {
    t += (now - before) / 1000 * Number(byId("rate").value);
    before = now;
    let next = shown;
    while (next < frames.length - 1 && frames[next + 1].time <= t) next++;
    if (next !== shown) show(next);
    if (next === frames.length - 1) { playing = null; byId("play").textContent = "Play"; return; }
    playing = requestAnimationFrame(tick);
  };
  playing = requestAnimationFrame(tick);
}

function startPlayer() {
  for (const [key, colour] of Object.entries(COLOURS)) element(byId("colour"), "option", { value: key }, colour.name);
  byId("slider").max = Math.max(frames.length - 1, 0);
  byId("slider").addEventListener("input", (event) => show(Number(event.target.value)));
  byId("colour").addEventListener("change", () => { legend(); draw(); });
  byId("gauges").addEventListener("change", draw);
  byId("play").addEventListener("click", play);
  byId("view-note").textContent = data.view_note + (data.planar ? "" : " Drag to turn.");
  if (!data.planar) view.addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    turn.yaw -= event.movementX * 0.01;
    turn.pitch = Math.min(Math.max(turn.pitch + event.movementY * 0.01, -1.5), 1.5);
    draw();
  });
  addEventListener("resize", draw);
  legend();
  show(0);
}
