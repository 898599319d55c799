// Quantities as people read them; SI units come in.

export const millimetres = (length) => `${Math.round(1e3 * length)} mm`;
export const newtons = (force) => `${force.toFixed(1)} N`;
export const share = (probability) => (probability > 0.999 ? "over 0.999" : probability.toFixed(3));
