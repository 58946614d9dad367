
// ---- the page's data, planner/results/report/plan_page.cc ----
const plan = JSON.parse(document.getElementById("plan-data").textContent);
const colours = ["#1f77b4", "#d9660f"], pale = ["#8cbbdc", "#f2b183"];
const at = id => document.getElementById(id);

// ---- a motion at an instant: columns between rows linear ----
let motion = plan.motions[0];
const endOf = m => m.time[m.time.length - 1];

function rowsAround(m, t) {
  let low = 0, high = m.time.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (m.time[middle] <= t) low = middle; else high = middle;
  }
  const fraction = (t - m.time[low]) / (m.time[high] - m.time[low]);
  return [low, high, Math.min(1, Math.max(0, fraction))];
}

function sample(m, t) {
  const [low, high, fraction] = rowsAround(m, t);
  const value = column => m[column][low] * (1 - fraction) + m[column][high] * fraction;
  const pair = column => [value(column + "1"), value(column + "2")];
  return { q: pair("q"), theta: pair("theta"), dtheta: pair("dtheta"), torque: pair("tau") };
}

// ---- the arm: x to the right, y up, q = 0 hangs straight down ----
const [l1, l2] = plan.arm.length;
const along = (from, angle, length) => [from[0] + length * Math.sin(angle), from[1] - length * Math.cos(angle)];
function pose(angles) {  // angle of link 1, angle of link 2 relative to link 1
  const elbow = along([0, 0], angles[0], l1);
  return { elbow, tip: along(elbow, angles[0] + angles[1], l2) };
}

const canvas = at("arm"), pen = canvas.getContext("2d");
let scale = 1, centre = [0, 0];  // pixels per m; of the joint

function fit() {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const reach = 1.12 * (l1 + l2);
  scale = Math.min(width, height) / (2 * reach);
  centre = [width / 2, height / 2];
}
const place = p => [centre[0] + scale * p[0], centre[1] - scale * p[1]];

function stroke(points, colour, width, dash = []) {
  pen.beginPath();
  points.forEach((p, i) => (i ? pen.lineTo(...place(p)) : pen.moveTo(...place(p))));
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.lineCap = dash.length ? "butt" : "round";
  pen.lineJoin = "round";
  pen.stroke();
  pen.setLineDash([]);
}

function disc(at, radius, fill, edge) {  // radius in m
  pen.beginPath();
  pen.arc(...place(at), radius * scale, 0, 2 * Math.PI);
  if (fill) { pen.fillStyle = fill; pen.fill(); }
  if (edge) { pen.strokeStyle = edge; pen.lineWidth = 1; pen.stroke(); }
}

// A capsule: the link with the radius that obstacles are kept from.
function capsule(from, to, radius, fill, edge) {
  const [a, b] = [place(from), place(to)], r = radius * scale;
  const angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
  pen.beginPath();
  pen.arc(...a, r, angle + Math.PI / 2, angle - Math.PI / 2);
  pen.arc(...b, r, angle - Math.PI / 2, angle + Math.PI / 2);
  pen.closePath();
  if (fill) { pen.fillStyle = fill; pen.fill(); }
  if (edge) { pen.strokeStyle = edge; pen.lineWidth = 1; pen.stroke(); }
}

// Canvas angle of a direction that is `angle` from straight down, counterclockwise.
const onCanvas = angle => Math.PI / 2 - angle;

// The spring between the motor's side and the link's: a zigzag along an arc.
function spring(joint, from, to, radius, fraction) {
  const steps = 16, amplitude = 0.014, points = [];
  for (let i = 0; i <= steps; ++i) {
    const off = i === 0 || i === steps ? 0 : (i % 2 ? amplitude : -amplitude);
    points.push(along(joint, from + (to - from) * i / steps, radius + off));
  }
  const red = Math.round(200 * Math.min(1, fraction * fraction));
  stroke(points, `rgb(${50 + red}, ${Math.round(60 - 60 * fraction * fraction)}, 60)`, 1.6);
}

// Torque on a ring around the joint: its fraction of the limit, and which way it turns.
function torqueRing(joint, base, torque, limit, radius, colour) {
  const full = 1.5 * Math.PI / 2, fraction = Math.max(-1.15, Math.min(1.15, torque / limit));
  const [x, y] = place(joint), r = radius * scale;
  const ring = (to, colour, width) => {
    pen.beginPath();
    pen.arc(x, y, r, onCanvas(base), onCanvas(base + to), to > 0);
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.lineCap = "butt";
    pen.stroke();
  };
  ring(full, "#e2e2e2", 3);
  ring(-full, "#e2e2e2", 3);
  if (Math.abs(fraction) < 0.01) return;
  const strong = Math.abs(torque) > 1.005 * limit ? "#c00" : colour;
  ring(fraction * full, strong, 4);
  const head = onCanvas(base + fraction * full), way = fraction > 0 ? -1 : 1;  // canvas angles run the other way
  const [hx, hy] = [x + r * Math.cos(head), y + r * Math.sin(head)], tangent = head + way * Math.PI / 2;
  pen.beginPath();
  pen.moveTo(hx + 9 * Math.cos(tangent), hy + 9 * Math.sin(tangent));
  pen.lineTo(hx + 6 * Math.cos(head), hy + 6 * Math.sin(head));
  pen.lineTo(hx - 6 * Math.cos(head), hy - 6 * Math.sin(head));
  pen.closePath();
  pen.fillStyle = strong;
  pen.fill();
}

// ---- what else there is in the plane ----
const scenery = {
  disc: o => {
    disc(o.center, o.radius + o.margin, null, "#e3a9a9");
    disc(o.center, o.radius, "#f3d9d9", "#b55");
  },
  wall: o => {  // hatched on the far side
    const size = Math.hypot(...o.normal), [nx, ny] = o.normal.map(n => n / size), far = 3, step = 0.03;
    const on = along => [o.at[0] - ny * along, o.at[1] + nx * along];
    stroke([on(-far), on(far)], "#b55", 2);
    for (let along = -far; along < far; along += step) {
      const [x, y] = on(along);
      stroke([[x, y], [x - 0.02 * nx - 0.02 * ny, y - 0.02 * ny + 0.02 * nx]], "#e3a9a9", 1);
    }
  },
  box: o => {
    const [[x0, y0], [x1, y1]] = o.corners;
    stroke([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], "#3a7d44", 1.2, [6, 4]);
  },
  line: o => {
    stroke([o.from, o.to], "#d8ead8", Math.max(1, 2 * o.tolerance * scale));
    stroke([o.from, o.to], "#3a7d44", 1);
  },
  arc: o => {
    const points = Array.from({ length: 61 }, (_, i) => onArc(o, o.from + (o.to - o.from) * i / 60));
    stroke(points, "#d8ead8", Math.max(1, 2 * o.tolerance * scale));
    stroke(points, "#3a7d44", 1);
  },
  curve: o => stroke(o.points, "#8fc49a", 3),
  point: o => disc(o.at, 0.008, "#3a7d44"),
};
const onArc = (o, angle) => [o.center[0] + o.radius * Math.cos(angle), o.center[1] + o.radius * Math.sin(angle)];
const anchorOf = o => o.kind === "arc" ? onArc(o, o.from) : o.at || o.center || o.from || (o.corners || o.points)[0];

function drawScene() {
  for (const object of plan.scene) {
    scenery[object.kind](object);
    const [x, y] = place(anchorOf(object));
    pen.fillStyle = "#3a7d44";
    pen.font = "12px system-ui, sans-serif";
    pen.fillText(object.label, x + 8, y - 6);
  }
}

// The tip's way, once per motion.
const ways = new Map();
function wayOf(m) {
  if (!ways.has(m)) ways.set(m, m.time.map((_, i) => pose([m.q1[i], m.q2[i]]).tip));
  return ways.get(m);
}

function drawArm(t) {
  const now = sample(motion, t), [r1, r2] = plan.arm.radius;
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  disc([0, 0], l1 + l2, null, "#eee");
  drawScene();
  const way = wayOf(motion), last = rowsAround(motion, t)[0];
  stroke(way, "#ccc", 1);
  stroke(way.slice(0, last + 1), "#888", 1.5);
  for (const row of [0, motion.time.length - 1]) {
    const still = pose([motion.q1[row], motion.q2[row]]);
    capsule([0, 0], still.elbow, r1, null, "#ccc");
    capsule(still.elbow, still.tip, r2, null, "#ccc");
  }
  const { elbow, tip } = pose(now.q);
  capsule([0, 0], elbow, r1, "#d3e4f2", colours[0]);
  capsule(elbow, tip, r2, "#fbe3d0", colours[1]);
  const joints = [[0, 0], elbow], bases = [0, now.q[0]];
  [0, 1].forEach(j => {
    const link = bases[j] + now.q[j], motor = bases[j] + now.theta[j];
    const limit = plan.limits.spring_deflection ? plan.limits.spring_deflection[j] : Infinity;
    stroke([joints[j], along(joints[j], motor, plan.arm.length[j])], colours[j], 1.3, [5, 4]);
    spring(joints[j], motor, link, 0.55 * plan.arm.length[j], Math.min(1, Math.abs(now.theta[j] - now.q[j]) / limit));
    if (plan.limits.torque) {
      torqueRing(joints[j], link + Math.PI, now.torque[j], plan.limits.torque[j], 0.075 - 0.02 * j, colours[j]);
    }
    disc(joints[j], 0.012, "#fff", "#333");
  });
  disc(tip, 0.008, "#333");
}

// ---- figures of the instant ----
function cell(row, text, heading = false) {
  const made = document.createElement(heading ? "th" : "td");
  made.textContent = text;
  row.append(made);
}
function showFigures(t) {
  const now = sample(motion, t), table = at("readout");
  table.replaceChildren();
  const heading = table.insertRow();
  ["", "link", "motor", "spring", "motor", "torque"].forEach(text => cell(heading, text, true));
  [0, 1].forEach(j => {
    const row = table.insertRow();
    cell(row, "joint " + (j + 1));
    cell(row, now.q[j].toFixed(3));
    cell(row, now.theta[j].toFixed(3));
    cell(row, (now.theta[j] - now.q[j]).toFixed(4));
    cell(row, now.dtheta[j].toFixed(2));
    cell(row, now.torque[j].toFixed(2));
  });
  const units = table.insertRow();
  ["", "rad", "rad", "rad", "rad/s", "N m"].forEach(text => cell(units, text));
}

// ---- the time that everything shares ----
let time = 0, playing = false, before = 0;

const linked = drawn.filter((_, i) => charts[i].time_axis).map(chart => {
  const line = document.createElement("div");
  line.className = "cursor";
  chart.canvas.parentElement.append(line);
  return { chart, line };
});

function moveCursors() {
  for (const { chart, line } of linked) {
    const area = chart.chartArea, x = chart.scales.x.getPixelForValue(time);
    line.style.display = x >= area.left - 0.5 && x <= area.right + 0.5 ? "block" : "none";
    line.style.transform = `translateX(${x}px)`;
    line.style.top = area.top + "px";
    line.style.height = area.bottom - area.top + "px";
  }
}

function show(t) {
  time = Math.max(0, Math.min(endOf(motion), t));
  at("time").value = Math.round(1000 * time / endOf(motion));
  at("now").textContent = time.toFixed(4) + " s";
  drawArm(time);
  showFigures(time);
  moveCursors();
}

function play(on) {
  playing = on;
  at("play").textContent = on ? "Pause" : "Play";
  if (!on) return;
  if (time >= endOf(motion)) time = 0;
  before = performance.now();
  requestAnimationFrame(tick);
}

function tick(instant) {
  if (!playing) return;
  const passed = Math.max(0, instant - before) / 1000 * Number(at("speed").value);
  before = instant;
  show(time + passed);
  if (time >= endOf(motion)) play(false); else requestAnimationFrame(tick);
}

// ---- controls ----
function go(t) {
  play(false);
  show(t);
}
at("play").addEventListener("click", () => play(!playing));
at("time").addEventListener("input", event => go(event.target.value / 1000 * endOf(motion)));
plan.motions.forEach((m, i) => at("motion").append(new Option(m.name, i)));
at("motion-label").hidden = plan.motions.length < 2;
at("motion").addEventListener("change", event => {
  motion = plan.motions[event.target.value];
  show(time);
});
document.addEventListener("keydown", event => {
  if (event.key !== " " || /^(BUTTON|SELECT|INPUT|SUMMARY)$/.test(event.target.tagName)) return;
  event.preventDefault();
  play(!playing);
});
for (const { chart } of linked) {
  const seek = event => go(chart.scales.x.getValueForPixel(event.offsetX));
  chart.canvas.addEventListener("click", seek);
  chart.canvas.addEventListener("pointermove", event => {
    if (event.pointerType === "mouse" && event.buttons === 1) seek(event);
  });
}
for (const button of document.querySelectorAll("button.at")) {
  button.addEventListener("click", () => {
    go(Number(button.dataset.time));
    canvas.scrollIntoView({ block: "nearest", behavior: "smooth" });
  });
}
new ResizeObserver(() => {
  fit();
  show(time);
}).observe(canvas);
