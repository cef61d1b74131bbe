// Line plots of the last minute and bars of residuals, on plain canvases.

const COLOURS = ["#d1495b", "#2e933c", "#2f6fde"];
const SPAN_S = 60;

const short = (v) => (Math.abs(v) >= 10 ? v.toFixed(0) : v.toFixed(1));

function clear(canvas) {
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.font = "12px system-ui, sans-serif";
  context.lineWidth = 1;
  context.textBaseline = "middle";
  return context;
}

// points: [[second, [x, y, z] or null], …]; at least ±least is shown.
export function lines(canvas, points, least, unit) {
  const context = clear(canvas), ink = getComputedStyle(canvas).color;
  const { width, height } = canvas, left = 52, last = points.length ? points[points.length - 1][0] : 0;
  let most = least;
  for (const [, v] of points) if (v) for (const x of v) most = Math.max(most, Math.abs(x) * 1.1);
  const y = (v) => height / 2 - (v / most) * (height / 2 - 10);
  const x = (t) => width - 6 - ((last - t) / SPAN_S) * (width - left - 6);
  context.strokeStyle = ink; context.fillStyle = ink;
  for (const v of [-most, 0, most]) {
    context.globalAlpha = 0.25;
    context.beginPath(); context.moveTo(left, y(v)); context.lineTo(width, y(v)); context.stroke();
    context.globalAlpha = 0.8;
    context.textAlign = "right";
    context.fillText(short(v), left - 5, y(v));
  }
  context.textAlign = "left";
  context.fillText(unit, left + 4, 10);
  context.globalAlpha = 1; context.lineWidth = 1.8;
  for (let k = 0; k < 3; k++) {
    context.strokeStyle = COLOURS[k];
    context.beginPath();
    let on = false;
    for (const [t, v] of points) {
      if (!v || x(t) < left) { on = false; continue; }
      if (on) context.lineTo(x(t), y(v[k])); else context.moveTo(x(t), y(v[k]));
      on = true;
    }
    context.stroke();
    context.fillStyle = COLOURS[k];
    context.fillText("xyz"[k], left + 60 + 16 * k, 10);
  }
}

// residual: {pose: [x, y, z] mg}
export function bars(canvas, residual) {
  const context = clear(canvas), ink = getComputedStyle(canvas).color;
  const names = Object.keys(residual).filter((name) => Array.isArray(residual[name])).sort();
  const { width, height } = canvas, left = 52;
  let most = 0.1;
  for (const name of names) for (const v of residual[name]) most = Math.max(most, Math.abs(v) || 0);
  const y = (v) => (height - 18) / 2 - (v / most) * ((height - 18) / 2 - 8);
  context.fillStyle = ink; context.strokeStyle = ink; context.globalAlpha = 0.8;
  context.textAlign = "right";
  for (const v of [-most, 0, most]) context.fillText(short(v), left - 5, y(v));
  context.textAlign = "left"; context.fillText("mg", left + 4, 8);
  context.globalAlpha = 0.3;
  context.beginPath(); context.moveTo(left, y(0)); context.lineTo(width, y(0)); context.stroke();
  context.globalAlpha = 1;
  const step = (width - left) / Math.max(1, names.length);
  names.forEach((name, n) => {
    residual[name].slice(0, 3).forEach((v, k) => {
      context.fillStyle = COLOURS[k];
      context.fillRect(left + n * step + 4 + k * (step - 10) / 3, Math.min(y(0), y(v)),
                       (step - 12) / 3, Math.abs(y(v) - y(0)));
    });
    context.fillStyle = ink; context.textAlign = "center";
    context.fillText(name, left + (n + 0.5) * step - 2, height - 8);
  });
}
