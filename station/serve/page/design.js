// Design: cloth of any thread of the library or of the ready ones, or of two, in any ready draft and shape; what was woven, to look at and to download.

import {beginLook, lookAt, viewWanted} from "/design_look.js";
import {allow, byId, fill, make, show, text} from "/document.js";
import {tellClipping} from "/exposure.js";
import {said} from "/phrases.js";
import {picture, startJob, state, whyNot} from "/station.js";

const kPrinted_cm = [10, 20, 40], kDotsPerCm = 300 / 2.54;

let wanted = "";    // the thread that the address names
let proposed = "";  // the name that the page gave

export function chooseThread(number) { wanted = number; }

function showDraft() { byId("design-draft").src = picture({of: "draft", name: byId("design-form").draft.value}); }

// A name that a person has typed stays.
function propose() {
  const form = byId("design-form"), threads = form.warp.value === form.weft.value ? form.warp.value : `${form.warp.value} x ${form.weft.value}`;
  if (form.name.value && form.name.value !== proposed) return;
  form.name.value = proposed = `${form.draft.value} ${form.shape.value} ${threads}`;
}

// A thread of the library is a number, a ready one a name.
const threadOf = value => state.ready_threads.includes(value) ? value : Number(value);

const clothWanted = form => ({number: threadOf(form.warp.value), weft: threadOf(form.weft.value), draft: form.draft.value, shape: form.shape.value,
                                fibers: form.fibers.value});

// For other programs: a job makes it, and then it can be taken.
function exported(design) {
  const name = `${design.name}-gltf`, words = `${text("design_gltf")} ${design.name}`;
  if (state.exports.includes(name))
    return make("a", {href: "/download?" + new URLSearchParams({name}), download: `${name}.zip`, textContent: `${text("download")} ${name}.zip`});
  const button = make("button", {type: "button", textContent: text("design_gltf"), ariaLabel: words});
  button.onclick = () => startJob({kind: "design_export", design: design.name, name});
  allow(button, whyNot());
  return button;
}

function shown(design) {
  const card = make("article", {className: "thread"}, make("h3", {textContent: design.name}));
  if (design.problem) return card.append(make("p", {textContent: said(design.problem)})), card;
  const [warp, weft] = design.threads;
  card.append(make("p", {textContent: `${design.draft} · ${warp === weft ? warp : `${text("warp")} ${warp} · ${text("weft")} ${weft}`}`}),
    ...design.pictures.map(view => {
      const clipped = make("figcaption", {className: "dim"}), image = make("img", {alt: `${design.name}: ${text(`cloth_${view}`)}`, loading: "lazy"});
      tellClipping(image, clipped).src = picture({of: "design", name: design.name, view, made: design.made});
      return make("figure", {}, image, clipped);
    }),
    make("p", {}, make("a", {href: "/download?" + new URLSearchParams({of: "design", name: design.name}), download: `${design.name}.zip`,
                             textContent: `${text("download")} ${design.name}.zip`})),
    make("p", {}, exported(design)));
  return card;
}

export function showDesign() {
  const form = byId("design-form"), numbers = state.threads.map(thread => String(thread.number)), threads = [...numbers, ...state.ready_threads];
  byId("design-none").hidden = numbers.length > 0;
  const titles = [...state.threads.map(thread => `${thread.number} · ${thread.name}`), ...state.ready_threads.map(name => `${name} · ${text("ready_thread")}`)];
  for (const list of [form.warp, form.weft]) fill(list, threads, titles);
  if (numbers.includes(wanted)) form.warp.value = form.weft.value = wanted;
  wanted = "";
  fill(form.draft, state.drafts);
  fill(form.shape, state.shapes, state.shapes.map(shape => text(`cloth_${shape}`)));
  fill(form.fibers, ["", ...state.fibers], [text("fibers_none"), ...state.fibers.map(kind => text(`fibers_${kind}`))]);
  fill(form.size, ["", ...kPrinted_cm.map(String)], [text("size_screen"), ...kPrinted_cm.map(cm => text("size_print", {cm}))]);
  if (!byId("design-draft").src && state.drafts.length) showDraft();
  if (threads.length && document.activeElement !== form.name) propose();
  if (threads.length && state.drafts.length) lookAt(clothWanted(form));
  allow(form.querySelector(".primary"), whyNot());
  byId("design-why").textContent = whyNot();
  show(byId("designs"), [state.designs, state.exports, whyNot()], () => [...state.designs].sort((a, b) => b.made - a.made).map(shown));
}

export function beginDesign() {
  const form = byId("design-form");
  beginLook();
  form.onchange = () => {
    showDraft();
    propose();
    lookAt(clothWanted(form));
  };
  form.onsubmit = event => {
    event.preventDefault();
    const size = form.size.value && {size_px: Math.round(kDotsPerCm * Number(form.size.value))};
    startJob({kind: "design", name: form.name.value, ...clothWanted(form), ...viewWanted(), ...size, quick: form.quick.checked});
  };
}
