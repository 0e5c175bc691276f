// Design: cloth of any thread of the library, or of two, in any ready draft; what was woven, to look at and to download.

import {allow, byId, fill, make, show, text} from "/document.js";
import {tellClipping} from "/exposure.js";
import {said} from "/phrases.js";
import {picture, startJob, state, whyNot} from "/station.js";

const kPictures = ["swatch", "cylinder"];

let wanted = "";    // the thread that the address names
let proposed = "";  // the name that the page gave

export function chooseThread(number) { wanted = number; }

function showDraft() { byId("design-draft").src = picture({of: "draft", name: byId("design-form").draft.value}); }

// A name that a person has typed stays.
function propose() {
  const form = byId("design-form"), threads = form.warp.value === form.weft.value ? form.warp.value : `${form.warp.value} x ${form.weft.value}`;
  if (form.name.value && form.name.value !== proposed) return;
  form.name.value = proposed = `${form.draft.value} ${threads}`;
}

function shown(design) {
  const card = make("article", {className: "thread"}, make("h3", {textContent: design.name}));
  if (design.problem) return card.append(make("p", {textContent: said(design.problem)})), card;
  const [warp, weft] = design.threads;
  card.append(make("p", {textContent: `${design.draft} · ${warp === weft ? warp : `${text("warp")} ${warp} · ${text("weft")} ${weft}`}`}),
    ...kPictures.map(view => {
      const clipped = make("figcaption", {className: "dim"}), image = make("img", {alt: `${design.name}: ${text(`cloth_${view}`)}`, loading: "lazy"});
      tellClipping(image, clipped).src = picture({of: "design", name: design.name, view, made: design.made});
      return make("figure", {}, image, clipped);
    }),
    make("p", {}, make("a", {href: "/download?" + new URLSearchParams({of: "design", name: design.name}), download: `${design.name}.zip`,
                             textContent: `${text("download")} ${design.name}.zip`})));
  return card;
}

export function showDesign() {
  const form = byId("design-form"), numbers = state.threads.map(thread => thread.number);
  byId("design-none").hidden = numbers.length > 0;
  form.hidden = numbers.length === 0;
  for (const list of [form.warp, form.weft]) fill(list, numbers, state.threads.map(thread => `${thread.number} · ${thread.name}`));
  if (numbers.map(String).includes(wanted)) form.warp.value = form.weft.value = wanted;
  wanted = "";
  fill(form.draft, state.drafts);
  if (!byId("design-draft").src && state.drafts.length) showDraft();
  if (numbers.length && document.activeElement !== form.name) propose();
  allow(form.querySelector(".primary"), whyNot());
  byId("design-why").textContent = whyNot();
  show(byId("designs"), state.designs, () => [...state.designs].sort((a, b) => b.made - a.made).map(shown));
}

export function beginDesign() {
  const form = byId("design-form");
  form.onchange = () => {
    showDraft();
    propose();
  };
  form.onsubmit = event => {
    event.preventDefault();
    startJob({kind: "design", name: form.name.value, number: Number(form.warp.value), weft: Number(form.weft.value), draft: form.draft.value, quick: form.quick.checked});
  };
}
