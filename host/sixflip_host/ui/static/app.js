// The page: shows what the server says, asks for what the person clicks. All state is the
// server's; whatever comes from a board is set as text, never as markup.

import { Attitude, AXES, draw, lying, product, about } from "/box.js";
import { element, headers, listen, problem, say, send, showLog } from "/page.js";
import { bars, lines } from "/plots.js";

const KEPT_S = 60;
const LOOK_MS = 4000;
const STANDARD_G = 9.80665;
const PLUG = "Plug the board into this computer: USB, the sensor wired to it, the firmware on it " +
  "(sixflip provision). ";
const LAY = "Lay the box on a table that does not shake, then start.";
const PLAYED = "A capture is played; no board is needed. Start when you like.";
let view = null, trail = [], shownAt = performance.now(), reportShown = false;
const attitude = new Attitude();

function heard(now) {
  if (now.trail) trail = now.trail;
  const before = view;
  view = now;
  if (now.vector && (!before || before.number !== now.number || moved(before, now)))
    trail.push([performance.now() / 1000 + offset(), now.vector, now.rate]);
  const last = trail.length ? trail[trail.length - 1][0] : 0;
  trail = trail.filter(([t]) => last - t < KEPT_S);
  attitude.heard(now.vector, now.rate, now.box === "capturing");
  show();
  look();
}
const moved = (a, b) => !a.vector || a.vector.some((v, k) => v !== b.vector[k]) ||
  (b.rate && (!a.rate || a.rate.some((v, k) => v !== b.rate[k])));

// The server's seconds are of another clock than this page's.
let shift = null;
function offset() {
  if (shift === null)
    shift = trail.length ? trail[trail.length - 1][0] - performance.now() / 1000 : 0;
  return shift;
}

// -- what is shown

const clock = (s) => Math.floor(s / 60) + ":" + String(Math.floor(s % 60)).padStart(2, "0");
const signed = (v, n) => (v < 0 ? "" : "+") + v.toFixed(n);

function show() {
  const v = view, running = v.live && v.stage !== "over";
  say("link", v.live ? "board connected" : v.found ? "board found at " + v.found : "no board connected");
  say("chip", v.chip);
  say("board", v.board && "board " + v.board);
  say("port", v.port);
  problem(v.problem || (v.stage === "calibrating" ? "" : v.error));
  const none = v.number === 0 && !v.busy, gone = !none && !v.live && v.stage !== "over" && !v.busy;
  say("head", v.busy ? v.busy + "…" : none ? "ready to begin" : gone ? "the board is gone" : v.step.head);
  say("detail", none ? (v.replay ? PLAYED : v.found ? LAY : PLUG + LAY) :
    gone ? "Plug it in again; then continue with what it has kept." : v.step.detail);
  say("waits", none ? "" : v.waits);
  showCapture(v);
  showFaces(v, running);
  showResult(v);
  say("vector", v.vector ? "xyz".split("").map((a, k) => a + " " + signed(v.vector[k], 3)).join("   ") +
    " g   |a| " + Math.hypot(...v.vector).toFixed(3) + " g" : "-");
  say("rate", v.rate ? "xyz".split("").map((a, k) => a + " " + signed(v.rate[k], 0)).join("   ") +
    " deg/s" : "");
  lines(element("accel"), trail.map(([t, a]) => [t, a]), 1.2, "g");
  lines(element("gyro"), trail.map(([t, , w]) => [t, w]), 20, "deg/s");
  element("start").disabled = running || !!v.busy;
  element("start").textContent = v.stage === "over" && !none ? "Start again" : "Start";
  element("continue").hidden = running || !!v.busy || !v.unfinished;
  element("undo").disabled = !running || !v.undo;
  element("stop").disabled = !running || v.stage !== "calibrating";
  element("pull").disabled = running || !!v.busy;
  element("report").disabled = running || !!v.busy || v.reporting;
  say("pulled", v.pulled && "fetched into " + v.pulled);
  element("reporting").hidden = !v.reporting;
  if (v.reporting || !v.report) { reportShown = false; element("reportframe").hidden = true; }
  if (v.report && !v.reporting && !reportShown) { reportShown = true; showReport(); }
  showLog(v.log);
}

function showCapture(v) {
  const share = v.capture ? v.capture.progress / Math.max(1, v.capture.total) : 0;
  element("capturebar").style.width = 100 * share + "%";
  element("capturebar").parentElement.setAttribute("aria-valuenow", Math.round(100 * share));
  say("capture", v.capture ? v.pose + ": " + Math.round(100 * share) + " %, keep still " +
    v.capture.left_s.toFixed(1) + " s" : "no capture under way");
  say("clock", v.gone_s === null ? "" : "session " + clock(v.gone_s) +
    (v.left_s === null ? "" : ", about " + clock(Math.max(0, v.left_s)) + " left"));
  const noise = v.noise;
  element("noisemeter").value = noise ? Math.min(1, noise.value / noise.limit) : 0;
  say("noise", noise ? noise.value.toPrecision(3) + " times the sensor's own, limit " + noise.limit : "-");
}

function showFaces(v, running) {
  const body = element("faces");
  if (!body.children.length) {
    for (const { face } of v.faces) {
      const row = body.insertRow();
      for (let k = 0; k < 3; k++) row.insertCell();
      row.cells[0].textContent = face;
      const again = document.createElement("button");
      again.type = "button";
      again.textContent = "again";
      again.id = "redo" + face;
      again.setAttribute("aria-label", "take " + face + " again");
      again.addEventListener("click", () => ask("redo", face));
      row.insertCell().append(again);
    }
  }
  v.faces.forEach((entry, n) => {
    const row = body.rows[n];
    row.className = running && v.step.face === entry.face ? "here" : "";
    "ab".split("").forEach((letter, k) => {
      const now = v.capture && v.pose === entry.face + letter;
      const text = now ? Math.round(100 * v.capture.progress / Math.max(1, v.capture.total)) + " %"
        : entry[letter] === null ? "·" : "✓";
      if (row.cells[1 + k].textContent !== text) row.cells[1 + k].textContent = text;
    });
    element("redo" + entry.face).disabled = !v.live || !!v.plan || v.number === 0 ||
      !(v.stage === "over" || v.stage === "calibrating" && (entry.a !== null || entry.b !== null));
  });
  element("plan").hidden = !v.plan;
  if (v.plan) say("plan", v.plan.at + " of " + v.plan.of + " placements; next " + v.plan.next);
}

function savedWords(saved) {
  if (!saved.slot) return "no";
  const where = "slot " + saved.slot + ", sequence " + saved.sequence;
  return saved.written === false ? "not written, no better than " + where + ": " + saved.reason : where;
}

function showResult(v) {
  const over = v.stage === "over" && v.number > 0 && !v.busy;
  element("main").className = over ? "over" : v.number === 0 && !v.busy ? "before" : "";
  element("result").hidden = !over;
  element("figures").hidden = !v.verdict;
  const s = v.solved, number = (x, n) => (typeof x === "number" ? x.toFixed(n) : "-");
  say("verdict", v.verdict || "none");
  element("verdict").className = ["good", "doubtful", "refused"].includes(v.verdict) ? v.verdict : "";
  say("reason", typeof s.reason === "string" ? s.reason : v.verdict ? "" : "The session ended before it was computed.");
  say("next-do", afterwards(v));
  if (!v.verdict) return;
  const three = (x, n) => (Array.isArray(x) ? x.map((y) => number(y, n)).join("  ") : "-");
  const gyro = s.gyro && typeof s.gyro === "object" ? s.gyro : null;
  const rows = [["table tilt", number(s.tilt_deg, 2) + " deg, faces agree to " + number(s.tilt_spread_deg, 2) + " deg"],
    ["residual", number(s.residual_mg_rms, 2) + " mg rms"], ["scale x y z", three(s.scale, 4)],
    ["bias x y z", three(biasInMg(s.v), 2) + " mg"],
    ["gyro", gyro ? gyro.verdict + ": " + gyro.reason : "-"],
    ["gyro scale x y z", gyro ? three(gyro.scale, 4) : "-"],
    ["gyro bias x y z", gyro ? three(gyro.bias_dps, 3) + " deg/s" : "-"],
    ["saved", savedWords(v.saved)]];
  const table = element("numbers");
  while (table.rows.length < rows.length) { const row = table.insertRow(); row.insertCell(); row.insertCell(); }
  rows.forEach(([name, value], n) => {
    table.rows[n].cells[0].textContent = name;
    table.rows[n].cells[1].textContent = value;
  });
  bars(element("residuals"), s.residual_mg && typeof s.residual_mg === "object" ? s.residual_mg : {});
}

// As everywhere: the reading of an axis without any force on it, in thousandths of g.
const biasInMg = (v) => (Array.isArray(v) ? v.map((x) =>
  (typeof x === "number" ? -1e3 * x / STANDARD_G : x)) : v);

function afterwards(v) {
  if (v.unfinished) return "Next: continue the unfinished; what was taken is kept. Or start again.";
  if (v.replay) return "Next: the report, or play it again. Of a replay nothing is kept.";
  if (v.verdict === "refused" || !v.verdict)
    return "Next: put right what is said here, then start again. The board keeps what it had before.";
  const kept = v.saved.slot && v.saved.written !== false;
  const now = kept ? "It is saved: from now on the board corrects every sample with it. " :
    "It was not saved" + (v.saved.reason ? " (" + v.saved.reason + ")" : "") +
    "; the board goes on with the correction it has. ";
  return now + (v.verdict === "doubtful" ?
    "Next: take the face with the longest residual again, or fetch the report to see why." :
    "Next: fetch capture and record, and look at the report; or unplug the board and use it.");
}

async function showReport() {
  const answer = await fetch("/api/report", { headers });
  if (!answer.ok) return;
  const frame = element("reportframe");
  frame.src = (await answer.json()).path;
  frame.hidden = false;
}

// -- what is asked for: with the number of the session that was seen, so that a second click,
//    a stale tab or a page loaded again changes nothing that is done already

const ask = (action, what = "") => view && send(action, view.number, what);
let looked = -LOOK_MS;
function look() {       // is a board there by now, and does it hold an unfinished session?
  if (view.number || view.busy || view.found || view.replay) return;
  if (performance.now() - looked < LOOK_MS) return;
  looked = performance.now();
  ask("look");
}
for (const id of ["start", "continue", "stop", "pull", "report"])
  element(id).addEventListener("click", () => ask(id));
element("undo").addEventListener("click", () => ask("undo", view ? view.undo : ""));

// -- the box, many times a second; the board tells a few

function animate(now) {
  const seconds = Math.min(0.1, (now - shownAt) / 1000);
  shownAt = now;
  attitude.step(seconds);
  const box = element("now");
  if (view && view.vector) {
    draw(box, attitude.m);
    box.dataset.face = attitude.face();
  }
  const step = view && view.step, target = step && step.face in AXES ? step.face : "";
  const canvas = element("next");
  if (target) {
    const phase = (now / 1000) % 4;
    let m = lying(target, step.kind === "hold" && step.pose.endsWith("b") ? 1 : 0);
    if (step.kind === "flip")
      m = product(about([0, 0, 1], Math.PI * Math.min(1, Math.max(0, phase - 1) / 1.5)), m);
    draw(canvas, m, true);
    say("nextcaption", step.kind === "flip" ? "half a turn, " + target + " stays up" : target + " up");
  }
  element("nextfigure").hidden = !target;
  canvas.dataset.face = target;
  requestAnimationFrame(animate);
}

requestAnimationFrame(animate);
listen(heard);
