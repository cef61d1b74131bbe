// What every page has: the line to the server, what is said and asked for. Whatever comes from a
// board is set as text, never as markup.

const KEY = "sixflip-token";
export const element = (id) => document.getElementById(id);

// -- the key to the server: behind the # of the address, which no server ever sees

function token() {
  if (location.hash.length > 1) {
    localStorage.setItem(KEY, location.hash.slice(1));
    history.replaceState(null, "", "/");
  }
  return localStorage.getItem(KEY) || "";
}
const SECRET = token();
export const headers = { "X-Sixflip-Token": SECRET };

// -- what the server says

// A browser keeps few connections to one server: a tab that nobody sees lets go of its own.
const seen = () => new Promise((done) => {
  if (!document.hidden) done();
  else document.addEventListener("visibilitychange", () => seen().then(done), { once: true });
});

export async function listen(heard) {
  for (;;) {
    await seen();
    const stop = new AbortController(), hide = () => stop.abort();
    document.addEventListener("visibilitychange", hide, { once: true });
    try {
      const answer = await fetch("/api/states", { headers, signal: stop.signal });
      if (answer.status === 403) {
        problem((await answer.json()).error);
        say("link", "refused");
        return;
      }
      await read(answer.body.getReader(), heard);
    } catch { /* the server has gone, or nobody looks; it is asked again */ }
    document.removeEventListener("visibilitychange", hide);
    if (stop.signal.aborted) continue;
    say("link", "the server does not answer; is sixflip ui still running?");
    await new Promise((done) => setTimeout(done, 1000));
  }
}

async function read(reader, heard) {
  const decoder = new TextDecoder();
  let text = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    text += decoder.decode(value, { stream: true });
    const rows = text.split("\n");
    text = rows.pop();
    for (const row of rows) if (row) heard(JSON.parse(row));
  }
}

// -- what is shown

export function say(id, text) {
  const where = element(id);
  if (where.textContent !== text) where.textContent = text;
}
export function problem(text) {
  element("problem").hidden = !text;
  say("problem", text || "");
}

let logged = "";
export function showLog(log) {
  const text = log.slice(-60).join("\n");
  if (text === logged) return;
  logged = text;
  const list = element("log"), items = log.slice(-60).map((line) => {
    const item = document.createElement("li");
    item.textContent = line;
    return item;
  });
  list.replaceChildren(...items);
  list.scrollTop = list.scrollHeight;
}

// -- what is asked for, with the number of the session that was seen

export async function send(action, number, what = "") {
  try {
    const answer = await fetch("/api/do", { method: "POST", body: JSON.stringify(
      { action, number, what }), headers: { ...headers, "Content-Type": "application/json" } });
    if (!answer.ok) problem((await answer.json()).error);
  } catch {
    problem("the server does not answer; is sixflip ui still running?");
  }
}
