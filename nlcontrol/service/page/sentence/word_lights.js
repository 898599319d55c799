// The words of a sentence in the colours of the parts that they set, and marks at what stands in the way.

import { element } from "../elements.js";

// The sentence in pieces, `{text, part}` each: `part` of the explanation's rows, "problem", or "".
export function lightedPieces(text, rows, problem) {
  const letters = [...text]; // places in a sentence are those of characters, not of UTF-16 units
  const parts = new Array(letters.length).fill("");
  const stretches = rows
    .filter((row) => row.part !== "filler")
    .flatMap((row) => row.spans.map(([start, end]) => ({ start, end, part: row.part })));
  stretches.sort((a, b) => b.end - b.start - (a.end - a.start)); // the narrowest counts
  stretches.push(...spansOf(problem).map(([start, end]) => ({ start, end, part: "problem" })));
  for (const { start, end, part } of stretches) parts.fill(part, start, end);
  const pieces = [];
  letters.forEach((letter, i) => {
    const last = pieces[pieces.length - 1];
    if (last?.part === parts[i]) last.text += letter;
    else pieces.push({ text: letter, part: parts[i] });
  });
  return pieces;
}

export function lightedWords(text, rows, problem) {
  return lightedPieces(text, rows, problem).map((piece) =>
    element("span", { class: "word", "data-part": piece.part || null }, piece.text));
}

function spansOf(problem) {
  if (!problem) return [];
  if (problem.spans?.length) return problem.spans;
  return problem.span ? [problem.span] : [];
}
