
// ---- the page's data, planner/results/report/plan_page.cc ----
const plan = JSON.parse(document.getElementById("plan-data").textContent);
const colours = ["#1f77b4", "#d9660f"], besideColour = "#8c56b5";
const byDay = { fills: ["#d3e4f2", "#fbe3d0"], spring: [50, 60, 60], forbidden: "#f3d9d9", margin: "#e3a9a9", edge: "#b55", wanted: "#3a7d44",
  tolerance: "#d8ead8", curve: "#8fc49a", ring: "#e2e2e2", still: "#ccc", way: "#888" };
const byNight = { fills: ["#1d3a52", "#553015"], spring: [200, 190, 190], forbidden: "#4a2626", margin: "#7a4343", edge: "#d77", wanted: "#7cc188",
  tolerance: "#234029", curve: "#4f8059", ring: "#3a3d42", still: "#5a5d62", way: "#aaa" };
let paint = byDay;
const at = id => document.getElementById(id);

// ---- a motion at an instant: columns between rows linear ----
let motion = plan.motions[0], beside = null;  // what is shown, and what over it; without a motion the poses asked for
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
const armOf = m => (m && m.arm) || plan.arm;
const inArms = fraction => fraction * (plan.arm.length[0] + plan.arm.length[1]);  // m: marks are as large as the arm asks for
const along = (from, angle, length) => [from[0] + length * Math.sin(angle), from[1] - length * Math.cos(angle)];
function pose(angles, [l1, l2]) {  // angle of link 1, angle of link 2 relative to link 1; lengths
  const elbow = along([0, 0], angles[0], l1);
  return { elbow, tip: along(elbow, angles[0] + angles[1], l2) };
}

const canvas = at("arm"), pen = canvas.getContext("2d");
const border = { left: 40, right: 8, top: 8, bottom: 32 };  // pixels, for the axes' numbers
let scale = 1, centre = [0, 0];  // pixels per m; of the first joint

// [least x, least y, largest x, largest y] of what is shown: the reach, and all of the scenery that ends somewhere near.
function extent() {
  const reach = 1.08 * Math.max(...[plan, ...plan.motions].map(m => armOf(m).length[0] + armOf(m).length[1]));
  const most = 3 * reach, box = [-reach, -reach, reach, reach];
  for (const object of plan.scene) {
    for (const [x, y, around] of (boundsOf[object.kind] || (() => []))(object)) {
      const near = v => Math.max(-most, Math.min(most, v));
      box[0] = Math.min(box[0], near(x - around));
      box[1] = Math.min(box[1], near(y - around));
      box[2] = Math.max(box[2], near(x + around));
      box[3] = Math.max(box[3], near(y + around));
    }
  }
  return box;
}

function fit() {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const [x0, y0, x1, y1] = extent(), inner = [width - border.left - border.right, height - border.top - border.bottom];
  scale = Math.max(1, Math.min(inner[0] / (x1 - x0), inner[1] / (y1 - y0)));
  centre = [border.left + inner[0] / 2 - scale * (x0 + x1) / 2, border.top + inner[1] / 2 + scale * (y0 + y1) / 2];
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
  const steps = 16, amplitude = inArms(0.021), points = [];
  for (let i = 0; i <= steps; ++i) {
    const off = i === 0 || i === steps ? 0 : (i % 2 ? amplitude : -amplitude);
    points.push(along(joint, from + (to - from) * i / steps, radius + off));
  }
  const red = Math.min(1, fraction * fraction), [r, g, b] = paint.spring;
  stroke(points, `rgb(${r + red * (250 - r)}, ${g - red * g}, ${b})`, 1.6);
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
  ring(full, paint.ring, 3);
  ring(-full, paint.ring, 3);
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
    disc(o.center, o.radius + o.margin, null, paint.margin);
    disc(o.center, o.radius, paint.forbidden, paint.edge);
  },
  wall: o => {  // hatched on the far side
    const size = Math.hypot(...o.normal), [nx, ny] = o.normal.map(n => n / size), far = inArms(4.6), step = inArms(0.046);
    const hatch = inArms(0.03);
    const on = along => [o.at[0] - ny * along, o.at[1] + nx * along];
    stroke([on(-far), on(far)], paint.edge, 2);
    for (let along = -far; along < far; along += step) {
      const [x, y] = on(along);
      stroke([[x, y], [x - hatch * (nx + ny), y - hatch * (ny - nx)]], paint.margin, 1);
    }
  },
  box: o => {
    const [[x0, y0], [x1, y1]] = o.corners;
    stroke([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], paint.wanted, 1.2, [6, 4]);
  },
  line: o => {
    stroke([o.from, o.to], paint.tolerance, Math.max(1, 2 * o.tolerance * scale));
    stroke([o.from, o.to], paint.wanted, 1);
  },
  arc: o => {
    stroke(pointsOf(o), paint.tolerance, Math.max(1, 2 * o.tolerance * scale));
    stroke(pointsOf(o), paint.wanted, 1);
  },
  curve: o => stroke(o.points, paint.curve, 3),
  point: o => disc(o.at, inArms(0.012), paint.wanted),
};
// Points, each with what is around it [m]; a wall ends nowhere.
const boundsOf = {
  disc: o => [[...o.center, o.radius + o.margin]],
  box: o => o.corners.map(corner => [...corner, inArms(0.015)]),
  line: o => [o.from, o.to].map(end => [...end, o.tolerance]),
  arc: o => pointsOf(o).map(point => [...point, o.tolerance]),
  curve: o => o.points.map(point => [...point, inArms(0.015)]),
  point: o => [[...o.at, inArms(0.03)]],
};
const pointsOf = o => Array.from({ length: 61 }, (_, i) => onArc(o, o.from + (o.to - o.from) * i / 60));
const onArc = (o, angle) => [o.center[0] + o.radius * Math.cos(angle), o.center[1] + o.radius * Math.sin(angle)];
const anchorOf = o => o.kind === "arc" ? onArc(o, o.from) : o.at || o.center || o.from || (o.corners || o.points)[0];

function drawScene() {
  for (const object of plan.scene) scenery[object.kind](object);
}

// Within the picture and over one another nowhere; on a ground of their own, so that they can be read on anything.
function drawLabels() {
  const taken = [];
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "left";
  for (const { text, at, colour } of labels()) {
    const width = pen.measureText(text).width, [px, py] = place(at), height = 15;
    const x = Math.max(border.left + 2, Math.min(canvas.clientWidth - border.right - width - 2, px + 8));
    let y = Math.max(border.top + height, Math.min(canvas.clientHeight - border.bottom - 6, py - 6));
    const hits = () => taken.some(other => Math.abs(other.y - y) < height && x < other.x + other.width + 4 && other.x < x + width + 4);
    for (let tries = 0; tries < 12 && hits(); ++tries) y += y > canvas.clientHeight / 2 ? -height : height;
    taken.push({ x, y, width });
    pen.lineWidth = 3;
    pen.setLineDash([]);
    pen.strokeStyle = ink("paper");
    pen.strokeText(text, x, y);
    pen.fillStyle = colour;
    pen.fillText(text, x, y);
  }
}
const labels = () => [
  ...plan.scene.map(o => ({ text: o.label, at: anchorOf(o), colour: paint.wanted })),
  ...(motion ? [] : plan.poses.map(p => ({ text: p.label, at: pose(p.q, plan.arm.length).tip, colour: ink("text") }))),
];

// Axes in m around the picture, and the frame at the first joint.
function drawAxes() {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const [left, right, top, bottom] = [border.left, width - border.right, border.top, height - border.bottom];
  const step = [0.1, 0.2, 0.5, 1, 2, 5].find(s => s * scale >= 38) || 10;
  pen.save();
  pen.strokeStyle = ink("grid");
  pen.fillStyle = ink("soft");
  pen.lineWidth = 1;
  pen.font = "11px system-ui, sans-serif";
  const number = v => String(+v.toFixed(2));
  const along = (low, high) => Array.from({ length: Math.floor(high / step) - Math.ceil(low / step) + 1 },
                                          (_, i) => (Math.ceil(low / step) + i) * step);
  pen.beginPath();
  pen.textAlign = "center";
  for (const x of along((left - centre[0]) / scale, (right - centre[0]) / scale)) {
    const px = centre[0] + scale * x;
    pen.moveTo(px, top);
    pen.lineTo(px, bottom);
    pen.fillText(number(x), px, bottom + 13);
  }
  pen.textAlign = "right";
  for (const y of along((centre[1] - bottom) / scale, (centre[1] - top) / scale)) {
    const py = centre[1] - scale * y;
    pen.moveTo(left, py);
    pen.lineTo(right, py);
    pen.fillText(number(y), left - 4, py + 4);
  }
  pen.stroke();
  pen.textAlign = "center";
  pen.fillText("x (m)", (left + right) / 2, height - 5);
  pen.translate(9, (top + bottom) / 2);
  pen.rotate(-Math.PI / 2);
  pen.fillText("y (m)", 0, 0);
  pen.restore();
}

// Which way gravity pulls in the plane, in a corner of the picture: not at all on a table, by a part of it on a slope.
function drawGravity() {
  const { fraction, down } = plan.gravity, level = Math.abs(fraction) < 1e-9, size = 30;
  const [x, y] = [border.left + 22, border.top + 22];
  const [dx, dy] = level ? [0, 0] : [Math.sin(down), Math.cos(down)];  // on the canvas, y down
  pen.strokeStyle = pen.fillStyle = ink("soft");
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x - size / 2 * dx, y - size / 2 * dy);
  pen.lineTo(x + size / 2 * dx, y + size / 2 * dy);
  for (const side of level ? [] : [-1, 1]) {
    pen.moveTo(x + size / 2 * dx, y + size / 2 * dy);
    pen.lineTo(x + size / 4 * dx + side * 5 * dy, y + size / 4 * dy - side * 5 * dx);
  }
  pen.stroke();
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "left";
  const share = fraction > 1 - 1e-9 ? "g" : `${+fraction.toPrecision(2)} g`;
  if (level) pen.fillText("no gravity", border.left + 6, border.top + 14); else pen.fillText(share, x + 8 + 12 * Math.abs(dx), y + 4);
}

// x and y at the first joint, to a tenth of the arm.
function drawFrame() {
  const size = 0.16 * (plan.arm.length[0] + plan.arm.length[1]);
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "left";
  for (const [name, way] of [["x", [1, 0]], ["y", [0, 1]]]) {
    const tip = [size * way[0], size * way[1]], head = 0.14 * size;
    stroke([[0, 0], tip], ink("soft"), 1.2);
    const [a, b] = [[tip[0] - head * (way[0] + 0.5 * way[1]), tip[1] - head * (way[1] + 0.5 * way[0])],
                    [tip[0] - head * (way[0] - 0.5 * way[1]), tip[1] - head * (way[1] - 0.5 * way[0])]];
    stroke([a, tip, b], ink("soft"), 1.2);
    pen.fillStyle = ink("soft");
    pen.fillText(name, place(tip)[0] + 4, place(tip)[1] - 3);
  }
}

// What is drawn until it is undone stays within the axes.
function withinAxes(draw) {
  pen.save();
  pen.beginPath();
  pen.rect(border.left, border.top, canvas.clientWidth - border.left - border.right, canvas.clientHeight - border.top - border.bottom);
  pen.clip();
  draw();
  pen.restore();
}

// The tip's way, once per motion.
const ways = new Map();
function wayOf(m) {
  if (!ways.has(m)) ways.set(m, m.time.map((_, i) => pose([m.q1[i], m.q2[i]], armOf(m).length).tip));
  return ways.get(m);
}

function drawPicture(t) {
  paint = atNight.matches ? byNight : byDay;
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  drawAxes();
  withinAxes(() => {
    const [l1, l2] = armOf(motion).length;
    disc([0, 0], l1 + l2, null, paint.still);
    drawScene();
    drawFrame();
    drawGravity();
    if (motion) drawArm(t); else drawPoses();
    if (beside) drawBeside(t);
    drawLabels();
  });
}

function outline(arm, q, fills, edges) {
  const { elbow, tip } = pose(q, arm.length);
  capsule([0, 0], elbow, arm.radius[0], fills[0], edges[0]);
  capsule(elbow, tip, arm.radius[1], fills[1], edges[1]);
  return { elbow, tip };
}

// Of a request that came to no motion.
function drawPoses() {
  plan.poses.forEach((p, i) => outline(plan.arm, p.q, i ? [] : paint.fills, i ? [paint.wanted, paint.wanted] : colours));
}

// The other motion at the same instant.
function drawBeside(t) {
  const now = sample(beside, Math.min(t, endOf(beside))), arm = armOf(beside);
  stroke(wayOf(beside), besideColour, 1, [3, 3]);
  pen.globalAlpha = 0.25;
  outline(arm, now.q, [besideColour, besideColour], []);
  pen.globalAlpha = 1;
  outline(arm, now.q, [], [besideColour, besideColour]);
}

function drawArm(t) {
  const now = sample(motion, t), arm = armOf(motion);
  const way = wayOf(motion), last = rowsAround(motion, t)[0];
  stroke(way, paint.still, 1);
  stroke(way.slice(0, last + 1), paint.way, 1.5);
  for (const row of [0, motion.time.length - 1]) {
    outline(arm, [motion.q1[row], motion.q2[row]], [], [paint.still, paint.still]);
  }
  const { elbow, tip } = outline(arm, now.q, paint.fills, colours);
  const joints = [[0, 0], elbow], bases = [0, now.q[0]];
  [0, 1].forEach(j => {
    const link = bases[j] + now.q[j], motor = bases[j] + now.theta[j];
    const limit = plan.limits.spring_deflection ? plan.limits.spring_deflection[j] : Infinity;
    stroke([joints[j], along(joints[j], motor, arm.length[j])], colours[j], 1.3, [5, 4]);
    spring(joints[j], motor, link, 0.55 * arm.length[j], Math.min(1, Math.abs(now.theta[j] - now.q[j]) / limit));
    if (plan.limits.torque) {
      torqueRing(joints[j], link + Math.PI, now.torque[j], plan.limits.torque[j], inArms(0.115 - 0.03 * j), colours[j]);
    }
    disc(joints[j], inArms(0.018), ink("paper"), ink("text"));
  });
  disc(tip, inArms(0.012), ink("text"));
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
  ["", "link", "motor", "spring", "speed", "torque"].forEach(text => cell(heading, text, true));
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

// Of what is shown: with another motion over it until both have ended.
const lastTime = () => Math.max(endOf(motion), beside ? endOf(beside) : 0);

function show(t) {
  if (!motion) return drawPicture(0);
  time = Math.max(0, Math.min(lastTime(), t));
  at("time").value = Math.round(1000 * time / lastTime());
  at("now").textContent = time.toFixed(4) + " s";
  drawPicture(time);
  showFigures(time);
  moveCursors();
}

function play(on) {
  playing = on;
  at("play").textContent = on ? "Pause" : "Play";
  if (!on) return;
  if (time >= lastTime()) time = 0;
  before = performance.now();
  requestAnimationFrame(tick);
}

function tick(instant) {
  if (!playing) return;
  const passed = Math.max(0, instant - before) / 1000 * Number(at("speed").value);
  before = instant;
  show(time + passed);
  if (time >= lastTime()) play(false); else requestAnimationFrame(tick);
}

// ---- controls ----
function go(t) {
  play(false);
  show(t);
}
at("play").addEventListener("click", () => play(!playing));
at("time").addEventListener("input", event => go(event.target.value / 1000 * lastTime()));
plan.motions.forEach((m, i) => {
  at("motion").append(new Option(m.name, i));
  at("beside").append(new Option(m.name, i));
});
at("motion-label").hidden = at("beside-label").hidden = plan.motions.length < 2;
at("motion").addEventListener("change", event => {
  motion = plan.motions[event.target.value];
  show(time);
});
at("beside").addEventListener("change", event => {
  beside = plan.motions[event.target.value] || null;
  show(time);
});
if (plan.beside !== undefined) {
  at("beside").value = plan.beside;
  beside = plan.motions[plan.beside];
}
at("stage").classList.toggle("still", !motion);
atNight.addEventListener("change", () => show(time));
document.addEventListener("keydown", event => {
  if (!motion || event.key !== " " || /^(BUTTON|SELECT|INPUT|SUMMARY)$/.test(event.target.tagName)) return;
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
