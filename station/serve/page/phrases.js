// What the program itself says, in the page's language: its sentences are looked up in phrases.LANGUAGE.json, where {a}, {b}
// stand for what varies. Another language is one more file; English needs none.

const kJoins = 8;  // a template with fewer letters of its own only joins what is known

const kBorder = /[.!?]\s/;  // between two sentences: no value reaches across

let templates = null, known = new Map();

// What was looked up of late, null where nothing fits: a log is shown again and again.
const kKept = 5000, looked = new Map();

// What was shown without a translation.
export const untold = new Set();

const literal = words => words.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");

function templateOf(english, own) {
  const letters = [...english.matchAll(/\{([a-z])\}/g)].map(found => found[1]), words = english.split(/\{[a-z]\}/);
  return {pattern: new RegExp(`^${words.map(literal).join("(.+?)")}$`), letters, own, length: words.join("").replace(/\W/g, "").length};
}

export async function readPhrases(language) {
  if (language === "en") return;
  const phrases = await (await fetch(`/phrases.${language}.json`)).json();
  known = new Map(Object.entries(phrases));
  templates = Object.entries(phrases).filter(([english]) => /\{[a-z]\}/.test(english)).map(([english, own]) => templateOf(english, own))
    .sort((one, other) => other.length - one.length);
}

// Numbers, names of files and of steps are no words: "1.5 px", "reflection-1", "rig.json".
const kName = /^[\w./:#-]*[\d_./:#-][\w./:#-]*\w$/, kUnits = /^[\d.,+-]+ ?(px|mm|cm|m|s|min|h|DN|EV|%)?$/;
const isWord = words => /[A-Za-z]{2}/.test(words) && !kName.test(words) && !kUnits.test(words);

// None where the catalogue has nothing that fits.
function whole(words) {
  if (!isWord(words)) return words;
  if (known.has(words)) return known.get(words);
  if (looked.size > kKept) looked.clear();
  if (!looked.has(words)) looked.set(words, byTemplate(words));
  return looked.get(words);
}

function byTemplate(words) {
  for (const template of templates) {
    const found = words.match(template.pattern);
    if (!found || found.slice(1).some(value => kBorder.test(value))) continue;
    const values = found.slice(1).map(value => pieces(value));
    if (template.length < kJoins && values.includes(null)) continue;
    return template.own.replace(/\{([a-z])\}/g, (all, letter) => {
      const at = template.letters.indexOf(letter);
      return values[at] ?? found[at + 1];
    });
  }
  return null;
}

// As a whole, line by line, or sentence by sentence; none where a part is unknown.
function pieces(words) {
  const found = whole(words);
  if (found !== null) return found;
  for (const border of [/(\n+)/, /((?<=[.!?:])\s+)/]) {
    const parts = words.split(border);
    if (parts.length < 2) continue;
    const told = parts.map((part, i) => i % 2 ? part : pieces(part));
    return told.includes(null) ? null : told.join("");
  }
  return null;
}

// `counted`: whether it is missed in `untold` where nothing fits.
export function said(words, counted = true) {
  if (!templates || !words) return words || "";
  const found = pieces(words);
  if (found !== null) return found;
  return words.split(/(\n+|(?<=[.!?:])\s+)/).map((part, i) => {
    const told = i % 2 ? part : pieces(part);
    if (told === null && counted) untold.add(part);
    return told ?? part;
  }).join("");
}
