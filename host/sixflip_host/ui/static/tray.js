// The page of a tray: several boards in one jig, a row each, and how the jig is to lie next.

import { AXES, about, draw, lying, product } from "/box.js";
import { element, listen, problem, say, send, showLog } from "/page.js";

let view = null;
const ask = (action, what = "") => view && send(action, view.number, what);

function heard(now) {
  view = now;
  say("link", now.live ? now.boards.length + " boards found" : "no session under way");
  say("jig", now.reference ? "X Y Z as on board " + now.reference : "several boards in one jig");
  problem(now.problem);
  say("head", now.busy ? now.busy + "…" : now.head);
  columns(now.faces);
  now.boards.forEach((board, n) => row(n, board, now));
  const body = element("boards");
  while (body.rows.length > now.boards.length) body.deleteRow(-1);
  const running = now.live && !now.over;
  for (const id of ["start", "continue"]) element(id).disabled = running || !!now.busy;
  element("undo").disabled = !running || !now.undo;
  element("stop").disabled = !running;
  showLog(now.log);
}

function columns(faces) {
  const head = element("columns");
  if (head.cells.length > 1) return;
  for (const face of faces) {
    const cell = document.createElement("th"), again = document.createElement("button");
    again.type = "button";
    again.textContent = face;
    again.id = "redo" + face;
    again.title = "take " + face + " again, by all boards";
    again.setAttribute("aria-label", again.title);
    again.addEventListener("click", () => ask("redo", face));
    cell.append(again);
    head.append(cell);
  }
  const last = document.createElement("th");
  last.textContent = "what it does, or what came of it";
  head.append(last);
}

function row(n, board, now) {
  const body = element("boards");
  if (!body.rows[n]) for (let k = 0; k < 2 + now.faces.length; k++)
    (k ? body.rows[n] : body.insertRow()).insertCell();
  const cells = body.rows[n].cells;
  const set = (cell, text) => { if (cell.textContent !== text) cell.textContent = text; };
  body.rows[n].className = board.awaited ? "here" : board.gone ? "gone" : "";
  set(cells[0], board.number + " " + board.id);
  cells[0].title = board.port + " " + board.chip;
  board.faces.forEach((marks, k) => set(cells[1 + k], marks));
  const last = cells[cells.length - 1];
  set(last, board.status);
  last.className = board.gone ? "refused" :
    ["good", "doubtful", "refused"].includes(board.verdict) ? board.verdict : "";
  now.faces.forEach((face) => { element("redo" + face).disabled = !now.live || !now.reference; });
}

for (const id of ["start", "continue", "stop"]) element(id).addEventListener("click", () => ask(id));
element("undo").addEventListener("click", () => ask("undo", view ? view.undo : ""));

function animate(now) {
  const step = view && view.step, target = step && step.face in AXES ? step.face : "";
  const canvas = element("next");
  if (target) {
    const phase = (now / 1000) % 4;
    let m = lying(target, step.kind === "hold" && step.letter === "b" ? 1 : 0);
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
