// The station behind the page: what it knows, and what it is asked to do.

import {byId, text} from "/document.js";

const kSoon_ms = 100, kLater_ms = 1000;  // until the state is asked for again: after a change, after a failure

const client = sessionStorage.client || (sessionStorage.client = crypto.randomUUID());

export let state = null;
export const inControl = () => state !== null && state.control === client;

// What the station says to everybody who hears this page, and everybody who reads the line.
export function say(words) { byId("said").textContent = words; }

// None where the station has nothing, or cannot be reached.
export async function ask(path, query = {}) {
  try {
    const answer = await fetch(path + "?" + new URLSearchParams(query));
    if (answer.ok) return await answer.json();
    say((await answer.json()).message);
  } catch { say(text("lost")); }
  return null;
}

// The answer with "ok".
export async function post(path, fields = {}) {
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: {"Content-Type": "application/json", "X-Threadstation": "page"},
      body: JSON.stringify({client, ...fields}),
    });
    const found = await answer.json();
    say(found.message);
    return {...found, ok: answer.ok};
  } catch {
    say(text("lost"));
    return {ok: false};
  }
}

export const startJob = fields => post("/api/job", fields);
export const picture = query => "/picture?" + new URLSearchParams(query);

// `work`, which is not begun again before it has ended: what was asked for meanwhile is done once, soon after.
export function oneAtATime(work) {
  let busy = false, again = false;
  const run = async () => {
    if (busy) { again = true; return; }
    busy = true;
    try {
      await work();
    } finally {
      busy = false;
      if (again) setTimeout(run, kSoon_ms);
      again = false;
    }
  };
  return run;
}

// `changed` is called now and whenever something has changed at the station.
export async function follow(changed) {
  const refresh = oneAtATime(async () => {
    const found = await ask("/api/state");
    if (!found) { setTimeout(refresh, kLater_ms); return; }
    state = found;
    changed();
  });
  await refresh();
  const events = new EventSource("/api/events");
  events.onmessage = refresh;
  events.onopen = refresh;
  events.onerror = () => say(text("lost"));
}
