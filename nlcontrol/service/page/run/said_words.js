// A sentence in its words, which light up where a verdict is about them.

import { element } from "../elements.js";
import { lightedPieces } from "../sentence/word_lights.js";

// The words of a sentence; `rows` of an explanation give them their colours.
export function saidWords(text, rows) {
  let at = 0; // places are those of characters
  const words = lightedPieces(text, rows, null).flatMap((piece) =>
    piece.text.split(/(\s+)/u).filter(Boolean).map((word) => ({ word, part: piece.part })));
  return words.map(({ word, part }) => {
    const start = at;
    at += [...word].length;
    const shown = word.trim() ? part || null : null;
    return element("span", { class: "word", "data-part": shown, "data-start": start, "data-end": at }, word);
  });
}

export function lightWords(sentence, spans, on) {
  for (const word of sentence.querySelectorAll(".word")) {
    const [start, end] = [Number(word.dataset.start), Number(word.dataset.end)];
    word.classList.toggle("lit", on && spans.some(([from, to]) => start < to && from < end));
  }
}
