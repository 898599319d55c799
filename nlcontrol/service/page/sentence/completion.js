// How a sentence may go on: with a name of the table, or with words of the language.

import { BEGINNINGS, ENDINGS } from "./phrases.js";

const MOST = 6;

// Whole texts that begin with `text`, each with the phrase at its end and how much of that was there.
export function completions(text, names, isComplete) {
  if (!text.trim()) return [];
  const found = [
    ...names.flatMap((name) => continued(text, name)),
    ...BEGINNINGS.filter((each) => each.startsWith(text.trimStart().toLowerCase()))
      .flatMap((each) => continued(text, each)),
    ...(/\s\S/.test(text.trim()) ? ENDINGS.flatMap((each) => continued(text, each)) : []),
    ...(isComplete && text.endsWith(" ") ? ENDINGS.map((each) => added(text, 0, each)) : []),
    ...(/(^|\s)(the|from)\s+$/i.test(text) ? names.map((each) => added(text, 0, each)) : []),
  ];
  found.sort((a, b) => b.length - a.length); // what is said of it already counts most
  const known = new Map(found.map((each) => [each.text, each]));
  return [...known.values()].slice(0, MOST);
}

// The text with a phrase of which it has the first letters already, from the start of a word.
function continued(text, phrase) {
  const lower = text.toLowerCase();
  for (let length = Math.min(phrase.length - 1, text.length); length > 0; length--) {
    const start = text.length - length;
    const begins = start === 0 || text[start - 1] === " ";
    if (begins && lower.endsWith(phrase.slice(0, length).toLowerCase())) {
      return [added(text, length, phrase)];
    }
  }
  return [];
}

function added(text, length, phrase) {
  return { text: `${text.slice(0, text.length - length)}${phrase} `, phrase, length };
}
