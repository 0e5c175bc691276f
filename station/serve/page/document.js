// Elements of the page, texts, and nothing else: no request, no state.

import {readPhrases} from "/phrases.js";

const kLanguages = ["en", "de"];

let texts = {};

export const language = () => document.documentElement.lang;

// Fills in every element that names its text, in the language that was chosen here, or else the browser's.
export async function readTexts() {
  const wanted = localStorage.language || navigator.language.slice(0, 2);
  document.documentElement.lang = kLanguages.includes(wanted) ? wanted : kLanguages[0];
  texts = await (await fetch(`/texts.${language()}.json`)).json();
  await readPhrases(language());
  for (const element of document.querySelectorAll("[data-text]")) element.textContent = text(element.dataset.text);
  for (const element of document.querySelectorAll("[data-label]")) element.setAttribute("aria-label", text(element.dataset.label));
  for (const element of document.querySelectorAll("[data-alt]")) element.alt = text(element.dataset.alt);
}

export function nextLanguage() {
  localStorage.language = kLanguages[(kLanguages.indexOf(language()) + 1) % kLanguages.length];
  location.reload();
}

// The text of a key, with {name} replaced by values.name.
export function text(key, values = {}) {
  return (texts[key] || key).replace(/\{(\w+)\}/g, (all, name) => values[name] ?? all);
}

export const hasText = key => key in texts;
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
  if (list.options.length === names.length && names.every((name, i) => list.options[i].value === name && list.options[i].text === titles[i])) return;
  const before = list.value;
  list.replaceChildren(...names.map((name, i) => new Option(titles[i], name)));
  if (names.includes(before)) list.value = before;
}

// Makes `element`'s content again only for something else than before, so that the focus stays where it is.
export function show(element, what, content) {
  const mark = JSON.stringify(what);
  if (element.shown === mark) return;
  element.shown = mark;
  element.replaceChildren(...content());
}

// A button can be pressed unless there is a reason why not, which is then said by it and, in words, beside it.
export function allow(button, reason) {
  button.disabled = Boolean(reason);
  button.title = reason || "";
}

export function items(list, lines) {
  list.replaceChildren(...lines.map(line => make("li", {textContent: line})));
}

export function time(seconds) {
  const minutes = Math.floor(seconds / 60);
  if (minutes >= 60) return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
  return minutes ? `${minutes} min ${Math.round(seconds % 60)} s` : `${Math.round(seconds)} s`;
}

// How long ago, in the unit that matters.
export function ago(utc) {
  const minutes = Math.max(0, (Date.now() - Date.parse(utc)) / 60000);
  if (minutes < 2) return text("just_now");
  if (minutes < 120) return text("minutes_ago", {n: Math.round(minutes)});
  return minutes < 2880 ? text("hours_ago", {n: Math.round(minutes / 60)}) : text("days_ago", {n: Math.round(minutes / 1440)});
}

export const percent = (part, digits = 1) => part === null || part === undefined ? "" : `${(100 * part).toFixed(digits)} %`;

// A row of a table: elements as they are, all else as words.
export function row(...cells) {
  return make("tr", {}, ...cells.map(cell => make("td", {}, cell instanceof Node ? cell : String(cell ?? ""))));
}
