// The station behind the page: what it knows, and what it is asked to do.

import {byId, text} from "/document.js";
import {said} from "/phrases.js";

const kSoon_ms = 100, kLater_ms = 1000;  // until the state is asked for again: after a change, after a failure

const client = sessionStorage.client || (sessionStorage.client = crypto.randomUUID());

export let state = null;
export const inControl = () => state !== null && state.control === client;
export const jobRuns = () => Boolean(state && state.job && state.job.running);

// Why nothing can be started now; empty when it can. A live view ends for the next job.
export function whyNot() {
  if (!inControl()) return text("not_in_control");
  return jobRuns() && state.job.kind !== "preview" ? text("job_runs", {job: text(`kind_${state.job.kind}`)}) : "";
}

export const go = (screen, name = "") => { location.hash = `#/${screen}${name ? "/" + encodeURIComponent(name) : ""}`; };

// What the station says to everybody who hears this page, and everybody who reads the line.
export function say(words) { byId("said").textContent = words; }

// None where the station has nothing, or cannot be reached.
export async function ask(path, query = {}) {
  try {
    const answer = await fetch(path + "?" + new URLSearchParams(query));
    if (answer.ok) return await answer.json();
    say(said((await answer.json()).message));
  } catch { say(text("lost")); }
  return null;
}

// The answer with "ok".
export async function post(path, fields = {}, told = true) {
  try {
    const answer = await fetch(path, {
      method: "POST",
      headers: {"Content-Type": "application/json", "X-Threadstation": "page"},
      body: JSON.stringify({client, ...fields}),
    });
    const found = await answer.json();
    if (told) say(said(found.message));
    return {...found, ok: answer.ok};
  } catch {
    say(text("lost"));
    return {ok: false};
  }
}

// What was started is seen on the bench.
export async function startJob(fields) {
  const answer = await post("/api/job", fields);
  if (answer.ok) go("bench");
  return answer;
}

// The emergency stop. That it has not reached the station must be seen by somebody who looks at the bench.
export async function stop() {
  const answer = await post("/api/stop");
  byId("not-stopped").hidden = answer.ok;
}

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
    document.body.dataset.reached = Boolean(found);
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
