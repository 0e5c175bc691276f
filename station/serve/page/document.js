// Elements of the page, texts, and nothing else: no request, no state.

let texts = {};

// Fills in every element that names its text.
export async function readTexts() {
  texts = await (await fetch("/texts.json")).json();
  for (const element of document.querySelectorAll("[data-text]")) element.textContent = text(element.dataset.text);
  for (const element of document.querySelectorAll("[data-label]")) element.setAttribute("aria-label", text(element.dataset.label));
  for (const element of document.querySelectorAll("[data-alt]")) element.alt = text(element.dataset.alt);
}

export const text = key => texts[key] || key;
export const byId = id => document.getElementById(id);

// make("p", {className: "dim"}, "words", otherElement)
export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

// make() for drawings; properties are attributes.
export function draw(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

// Puts the names into a list to choose from, and leaves what was chosen.
export function fill(list, names, titles = names) {
  if (list.options.length === names.length && names.every((name, i) => list.options[i].value === name)) return;
  const before = list.value;
  list.replaceChildren(...names.map((name, i) => new Option(titles[i], name)));
  if (names.includes(before)) list.value = before;
}

export function items(list, lines) {
  list.replaceChildren(...lines.map(line => make("li", {textContent: line})));
}

export function time(seconds) {
  const minutes = Math.floor(seconds / 60);
  return minutes ? `${minutes} min ${Math.round(seconds % 60)} s` : `${Math.round(seconds)} s`;
}

export const percent = part => part === null || part === undefined ? "" : `${(100 * part).toFixed(1)} %`;

// A row of a table: elements as they are, all else as words.
export function row(...cells) {
  return make("tr", {}, ...cells.map(cell => make("td", {}, cell instanceof Node ? cell : String(cell ?? ""))));
}
