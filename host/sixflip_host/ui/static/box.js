// The box in 3-D on a plain 2-D canvas: the faces that are seen, with their names.
// Body axes x y z; world: x right, y away, z up. A rotation is a 3 x 3 matrix, row by row,
// body -> world. No library, no GPU.

export const AXES = { "X+": [1, 0, 0], "X-": [-1, 0, 0], "Y+": [0, 1, 0], "Y-": [0, -1, 0],
                      "Z+": [0, 0, 1], "Z-": [0, 0, -1] };
// What is seen in front of the person, as in host/sixflip_host/guide/box_drawings.py.
const FRONT = { "Z+": "Y-", "Z-": "Y+", "X+": "Z+", "X-": "Z+", "Y+": "Z+", "Y-": "Z+" };
const HALF = [0.75, 0.55, 0.35];        // half the edges: a flat box, the chip's side is Z+
const COLOURS = { X: "#d1495b", Y: "#2e933c", Z: "#2f6fde" };
const EYE_DEG = 24;                     // the person looks down by so much

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.sqrt(dot(a, a));
export const times = (m, v) => [0, 3, 6].map((r) => m[r] * v[0] + m[r + 1] * v[1] + m[r + 2] * v[2]);
export const product = (a, b) => {
  const out = [];
  for (let r = 0; r < 3; r++) for (let c = 0; c < 3; c++)
    out.push(a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c]);
  return out;
};

// Rodrigues' formula; axis need not be of length 1.
export function about(axis, angle) {
  const n = norm(axis);
  if (n < 1e-9 || !angle) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const [x, y, z] = axis.map((v) => v / n), c = Math.cos(angle), s = Math.sin(angle), d = 1 - c;
  return [c + x * x * d, x * y * d - z * s, x * z * d + y * s,
          y * x * d + z * s, c + y * y * d, y * z * d - x * s,
          z * x * d - y * s, z * y * d + x * s, c + z * z * d];
}

// The attitude with a face up, its front face towards the person (world -y); half a turn on.
export function lying(face, turned) {
  const up = AXES[face], front = AXES[FRONT[face]];
  const away = front.map((v) => -v), right = cross(away, up);
  const m = [...right, ...away, ...up];
  return turned ? product(about([0, 0, 1], Math.PI * turned), m) : m;
}

// Follows the board: gravity says what is up, the gyro how it turns about the vertical.
export class Attitude {
  constructor() { this.m = lying("Z+"); this.bias = [0, 0, 0]; this.rate = null; this.up = null; }

  // A vector (g) and rate (deg/s) of the board; still: the rate is the gyro's own bias.
  heard(vector, rate, still) {
    const n = vector ? norm(vector) : 0;
    this.up = n > 0.3 ? vector.map((v) => v / n) : null;
    this.rate = rate;
    if (still && rate) this.bias = this.bias.map((b, k) => b + 0.3 * (rate[k] - b));
  }

  step(seconds) {
    if (this.rate) {
      const w = this.rate.map((v, k) => (v - this.bias[k]) * Math.PI / 180);
      if (norm(w) > 0.05) this.m = product(this.m, about(w, norm(w) * seconds));
    }
    if (!this.up) return;
    const now = times(this.m, this.up), axis = cross(now, [0, 0, 1]);
    const angle = Math.atan2(norm(axis), now[2]);
    if (angle > Math.PI - 1e-6) { this.m = product(about([1, 0, 0], 0.01), this.m); return; }
    this.m = product(about(axis, angle * Math.min(1, 6 * seconds)), this.m);
  }

  face() {
    let best = "Z+";
    for (const name of Object.keys(AXES))
      if (times(this.m, AXES[name])[2] > times(this.m, AXES[best])[2]) best = name;
    return best;
  }
}

function corners(axis) {
  const k = axis.findIndex((v) => v), i = (k + 1) % 3, j = (k + 2) % 3;
  return [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) => {
    const p = [0, 0, 0];
    p[k] = axis[k] * HALF[k]; p[i] = a * HALF[i]; p[j] = b * HALF[j];
    return p;
  });
}

// Seen from in front and a little to the right, above.
const LOOK = product(about([1, 0, 0], EYE_DEG * Math.PI / 180), about([0, 0, 1], -0.42));
const TO_THE_EYE = [-LOOK[3], -LOOK[4], -LOOK[5]];

// World -> canvas, in weak perspective.
function viewer(width, height) {
  const size = Math.min(width, height) * 0.42;
  return (p) => {
    const [x, y, z] = times(LOOK, p), scale = size / (1 + 0.08 * y);
    return { x: width / 2 + scale * x, y: height * 0.5 - scale * z, depth: y };
  };
}

function polygon(context, points) {
  context.beginPath();
  points.forEach((p, k) => (k ? context.lineTo(p.x, p.y) : context.moveTo(p.x, p.y)));
  context.closePath();
}

// Draw the box with the rotation m on a table.
export function draw(canvas, m, faint) {
  const context = canvas.getContext("2d"), see = viewer(canvas.width, canvas.height);
  const ink = getComputedStyle(canvas).color;
  context.clearRect(0, 0, canvas.width, canvas.height);
  let lowest = 0;
  for (const name of ["Z+", "Z-"])
    for (const p of corners(AXES[name])) lowest = Math.min(lowest, times(m, p)[2]);
  const table = [[-1.3, -1.2], [1.3, -1.2], [1.3, 1.2], [-1.3, 1.2]].map(([x, y]) => see([x, y, lowest]));
  polygon(context, table);
  context.globalAlpha = 0.18; context.fillStyle = ink; context.fill(); context.globalAlpha = 1;
  const seen = Object.keys(AXES).filter((name) => dot(times(m, AXES[name]), TO_THE_EYE) > 0);
  const sides = seen.map((name) => {
    const points = corners(AXES[name]).map((p) => see(times(m, p)));
    const middle = times(m, AXES[name].map((v, k) => v * HALF[k]));
    return { name, points, middle: see(middle), up: times(m, AXES[name])[2] };
  });
  for (const side of sides) {
    polygon(context, side.points);
    context.fillStyle = COLOURS[side.name[0]];
    context.globalAlpha = faint ? 0.6 : 1;
    context.fill();
    context.fillStyle = "#000"; context.globalAlpha = 0.4 * (1 - side.up) / 2; context.fill();
    context.globalAlpha = 1;
    context.strokeStyle = ink; context.lineWidth = 1.5; context.stroke();
    if (side.name === "Z+") chip(context, m, see);
    context.fillStyle = "#fff"; context.font = "bold 20px system-ui, sans-serif";
    context.textAlign = "center"; context.textBaseline = "middle";
    context.fillText(side.name, side.middle.x, side.middle.y);
  }
}

// The sensor's chip on the side Z+.
function chip(context, m, see) {
  const z = HALF[2] + 0.005;
  polygon(context, [[-0.5, -0.35], [-0.22, -0.35], [-0.22, -0.1], [-0.5, -0.1]]
    .map(([x, y]) => see(times(m, [x, y, z]))));
  context.fillStyle = "#222"; context.fill();
}
