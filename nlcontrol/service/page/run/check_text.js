// Verdicts in words: SI values as people read them.

const SCALES = {
  m: [1e3, " mm", 0], rad: [180 / Math.PI, "°", 1], N: [1, " N", 1], "m/s": [1e3, " mm/s", 0],
  s: [1, " s", 1], "m³": [1e6, " ml", 0], "": [1, "", 3],
};

// The mark of a verdict, and what it means.
export const VERDICTS = {
  held: ["✓", "held"], not_held: ["✗", "did not hold"], unknown: ["?", "unknown"],
};

// Why a clause can be neither confirmed nor denied, and what an observer saw of it.
export function doubtText({ verdict, why, low, high, unit, observed }) {
  const near = why === "too_near" && low !== null
    ? `; between ${valueText(low, unit)} and ${valueText(high, unit)}, too close to the limit to decide` : "";
  if (!observed || verdict === (observed.ok ? "held" : "not_held")) return near;
  return `${near}; true value (observer): ${valueText(observed.measured, unit)}`;
}

export function valueText(value, unit) {
  if (typeof value === "string") return value;
  const [scale, sign, digits] = SCALES[unit];
  const text = (value * scale).toFixed(digits);
  return (Number(text) === 0 ? text.replace("-", "") : text) + sign;
}

// What a check asked, with its tolerance.
export function askedText({ relation, expected, tolerance, unit }) {
  const asked = valueText(expected, unit);
  if (relation === "is" || tolerance === null) return `asked: ${asked}`;
  const missed = valueText(tolerance, unit);
  if (relation === "about") return `asked: ${asked} ± ${missed}`;
  const bound = relation === "at_most" ? "at most" : "at least";
  if (tolerance === 0) return `asked: ${bound} ${asked}`;
  if (expected === 0) return `asked: ${bound} ${missed}`;
  return `asked: ${bound} ${asked}, tolerance ${missed}`;
}

// The words of a sentence that spans cover; places are those of characters.
export function wordsOf(text, spans) {
  const letters = [...text];
  return spans.map(([start, end]) => letters.slice(start, end).join("")).join(" … ");
}
