// Sentences to begin with, and words to go on with; objects come from the table.

// `%` stands for an object of the table.
export const EXAMPLES = [
  "push the % away without toppling it",
  "topple the %",
  "push the % 5 cm to the left",
  "how heavy is the %?",
  "where can i push the % without toppling it?",
  "turn the % by 30 degrees",
];

export const BEGINNINGS = [
  "push the", "pull the", "topple the", "turn the", "tilt the", "lift the", "open the", "close the",
  "explore the", "how heavy is the", "how hard can i push the", "where can i push the",
  "what can you do with the", "where is the", "undo that", "why?",
];

export const ENDINGS = [
  "away", "to the left", "to the right", "toward you", "by 10 cm", "next to the", "against the",
  "without toppling it", "without turning it", "without touching the", "with at most 5 N", "slowly",
  "gently", "then", "and",
];
