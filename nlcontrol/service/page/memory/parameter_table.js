// What is believed of an object, each figure with its standard deviation.

import { drawing, element } from "../elements.js";

const WIDE = 100; // of a bar
const DEVIATIONS = 2; // that a bar shows, to each side

// Figures of a model; mass and friction as they are believed on the table now, if it stands there.
export function parameterTable(model, onTable) {
  const now = { ...model, ...onTable };
  const [x, y, z] = model.com ?? [];
  const lengths = (values) => values.map((each) => (1e3 * each).toFixed(0)).join(", ");
  const rows = [
    figure("mass", now.mass, now.mass_sd, "kg"),
    figure("friction at the table", now.friction, now.friction_sd),
    figure("friction at the finger", model.finger_friction, model.finger_friction_sd),
    ...(model.com_sd ? [["centre of mass", `${lengths([x, y, z])} ± ${lengths(model.com_sd)} mm`]] : []),
    ...(model.container ? [["contents", `${(1e3 * (model.container.contents_l ?? 0)).toFixed(0)} ml`]] : []),
    ...(model.lid ? [["lid", model.lid.kind]] : []),
  ];
  return element("table", { class: "figures" }, element("tbody", {}, ...rows.map(([name, ...cells]) =>
    element("tr", {}, element("td", {}, name), element("td", {}, ...cells)))));
}

function figure(name, value, sd, unit = "") {
  return [name, `${value.toPrecision(3)} ± ${sd.toPrecision(2)} ${unit} `, bar(value, sd)];
}

// The figure on a line from nothing to well above it, with a band of two standard deviations.
function bar(value, sd) {
  const most = 1.15 * (value + DEVIATIONS * sd);
  const at = (each) => (WIDE * Math.max(each, 0)) / most;
  const [low, high] = [at(value - DEVIATIONS * sd), at(value + DEVIATIONS * sd)];
  return drawing("svg", { class: "belief", viewBox: `0 0 ${WIDE} 8`, "aria-hidden": "true" },
    drawing("line", { x1: 0, x2: WIDE, y1: 4, y2: 4 }),
    drawing("rect", { x: low, width: high - low, y: 1, height: 6, rx: 3 }),
    drawing("circle", { cx: at(value), cy: 4, r: 3 }));
}
