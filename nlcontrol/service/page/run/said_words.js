// A sentence in its words, which light up where a verdict is about them.

import { element } from "../elements.js";

// The words of a sentence; `rows` of an explanation give them their colours.
export function saidWords(text, rows = []) {
  const parts = new Array([...text].length).fill(null);
  const stretches = rows.filter(({ part }) => part !== "filler")
    .flatMap(({ spans, part }) => spans.map(([start, end]) => ({ start, end, part })))
    .sort((a, b) => b.end - b.start - (a.end - a.start)); // the narrowest counts
  for (const { start, end, part } of stretches) parts.fill(part, start, end);
  let at = 0;
  return text.split(/(\s+)/u).filter(Boolean).map((word) => {
    const start = at;
    at += [...word].length;
    const part = word.trim() ? parts[start] : null;
    return element("span", { class: "word", "data-part": part, "data-start": start, "data-end": at }, word);
  });
}

export function lightWords(sentence, spans, on) {
  for (const word of sentence.querySelectorAll(".word")) {
    const [start, end] = [Number(word.dataset.start), Number(word.dataset.end)];
    word.classList.toggle("lit", on && spans.some(([from, to]) => start < to && from < end));
  }
}
