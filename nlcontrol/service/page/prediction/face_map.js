// The outcome map of a face: what a push does at each place, with the contact of the plan on it.

import { drawing, element } from "../elements.js";
import { isGivenUp } from "../service_api.js";
import { millimetres, newtons, share } from "./quantities.js";

const CONTACTS = 80; // about so many on a face
const FINEST = 0.01; // distance between them [m]
const OUTCOMES = {
  slide: "slides", topple: "topples", undecided: "slides or topples", none: "does not move",
};
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

// A choice of faces and the map of one of them; `sides` is the size of the object [m].
export function faceMap(api, { object, faces, contacts }, push, sides) {
  const chart = element("div", { class: "face-map" });
  const told = element("output", { class: "told", "aria-live": "polite" });
  const chosen = element("select", { "aria-label": "Face", onchange: () => load() },
    ...faces.map((face) => element("option", { value: face }, `${face} face`)));
  const load = async () => {
    told.textContent = "Computing the map of this face …";
    try {
      const spacing = spacingOf(sides);
      const map = await api.map({ object, face: chosen.value, spacing });
      const own = chosen.value === faces[0] && push ? { push, contacts } : { contacts: [] };
      chart.replaceChildren(chartOf(map, own, told));
    } catch (problem) {
      if (!isGivenUp(problem)) told.textContent = problem.detail ?? String(problem);
    }
  };
  load();
  return element("figure", { class: "outcomes" },
    element("figcaption", {}, "Outcomes of pushes, seen from outside: ", chosen),
    chart, element("div", { class: "beside" }, told, legend(push)));
}

function spacingOf([x, y, z]) {
  return Math.max(FINEST, Math.sqrt((Math.max(x, y) * z) / CONTACTS));
}

function chartOf(map, { push, contacts }, told) {
  const [columns, rows] = ["lateral", "height"].map((key) =>
    [...new Set(map.contacts.map((each) => round(each[key])))].sort((a, b) => a - b));
  const pitch = [columns, rows].map((places) => (places.length > 1 ? places[1] - places[0] : 0.01));
  const [wide, high] = pitch.map((each) => 1e3 * each);
  const [left, width] = [1e3 * columns[0] - wide / 2, wide * columns.length];
  const top = 1e3 * rows.at(-1) + high / 2; // the table is at the lower edge
  const cells = map.contacts.map((contact) => drawing("rect", {
    class: "cell", "data-outcome": contact.outcome, width: wide, height: high,
    x: 1e3 * contact.lateral - wide / 2, y: top - 1e3 * contact.height - high / 2,
  }));
  const lines = heightsOf(push).filter(([, z]) => z < top).map(([about, z]) =>
    drawing("line", { class: "height", "data-about": about, x1: left, x2: left + width, y1: top - z, y2: top - z }));
  const rings = contacts.map((contact) => {
    const [lateral, z] = placeOn(map, contact);
    return drawing("circle", { class: "ring", cx: 1e3 * lateral, cy: top - 1e3 * z, r: 7 });
  });
  const cursor = drawing("rect", { class: "cursor", width: wide, height: high, visibility: "hidden" });
  const made = drawing("svg", {
    viewBox: `${left} 0 ${width} ${top}`, tabindex: 0, role: "application",
    "aria-roledescription": "outcome map",
    "aria-label": `Outcomes of pushes on the ${map.face} face of the ${map.object}. Arrow keys move over it.`,
  }, patterns(), cells, lines, rings, cursor);
  follow(made, { map, cells, columns, rows, cursor, told });
  told.textContent = push ? `○ contact of this plan, ${millimetres(push.p_BC[2])} up` : "";
  return made;
}

// Heights at which the outcome changes: as believed, and in the worst case [mm].
function heightsOf(push) {
  const { critical_height: nominal, critical_height_worst: worst } = push?.prediction ?? {};
  return [["nominal", nominal], ["worst", worst]].filter(([, z]) => z).map(([about, z]) => [about, 1e3 * z]);
}

// Place of a contact on the map's face, which may look elsewhere if the object is round.
function placeOn(map, { place: [x, y, z], normal }) {
  const turn = Math.atan2(map.normal[1], map.normal[0]) - Math.atan2(normal[1], normal[0]);
  const turned = [x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn)];
  const [first] = map.contacts;
  const other = map.contacts.find((each) => each.lateral !== first.lateral) ?? first;
  const span = other.lateral - first.lateral || 1;
  const along = [0, 1].map((i) => (other.point[i] - first.point[i]) / span);
  const size = along[0] ** 2 + along[1] ** 2 || 1;
  const off = turned.map((each, i) => each - first.point[i]);
  return [first.lateral + (off[0] * along[0] + off[1] * along[1]) / size, z];
}

// Tells of the place under the pointer, or under the cursor that the arrow keys move.
function follow(made, { map, cells, columns, rows, cursor, told }) {
  let at = map.contacts.reduce((best, each, i) => (heightOff(each) < heightOff(map.contacts[best]) ? i : best), 0);
  const show = (index) => {
    at = index;
    const cell = cells[index];
    for (const key of ["x", "y"]) cursor.setAttribute(key, cell.getAttribute(key));
    cursor.setAttribute("visibility", "visible");
    told.textContent = textOf(map.contacts[index]);
  };
  made.addEventListener("pointermove", ({ target }) => {
    const index = cells.indexOf(target);
    if (index >= 0 && index !== at) show(index);
  });
  made.addEventListener("focus", () => show(at));
  made.addEventListener("keydown", (event) => {
    const step = STEPS[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const here = map.contacts[at];
    const [lateral, height] = [columns.indexOf(round(here.lateral)), rows.indexOf(round(here.height))];
    const wanted = [columns[lateral + step[0]], rows[height + step[1]]];
    const next = map.contacts.findIndex(
      (each) => round(each.lateral) === wanted[0] && round(each.height) === wanted[1]);
    if (next >= 0) show(next);
  });
}

function heightOff({ lateral, height }) {
  return Math.hypot(lateral, height - 0.03);
}

function textOf({ lateral, height, outcome, slide, topple, probability_slide: p, probability_topple: q }) {
  const side = Math.abs(lateral) < 5e-4 ? "in the middle" : `${millimetres(Math.abs(lateral))} ${lateral < 0 ? "left" : "right"}`;
  const from = (verb, force) => (force === null ? `never ${verb}` : `${verb} from ${newtons(force)}`);
  return `${millimetres(height)} up, ${side}: ${OUTCOMES[outcome]}. It ${from("slides", slide)} `
    + `(probability ${share(p)}), ${from("topples", topple)} (${share(q)}).`;
}

function legend(push) {
  const sample = (text, ...content) => element("li", {},
    drawing("svg", { viewBox: "0 0 14 14", "aria-hidden": "true" }, ...content), text);
  const outcomes = Object.entries(OUTCOMES).map(([outcome, text]) => sample(text, patterns(),
    drawing("rect", { class: "cell", "data-outcome": outcome, x: 0, y: 0, width: 14, height: 14 })));
  const heights = heightsOf(push).map(([about, z]) => sample(
    about === "nominal" ? `topples above ${Math.round(z)} mm` : `${Math.round(z)} mm in the worst case`,
    drawing("line", { class: "height", "data-about": about, x1: 0, x2: 14, y1: 7, y2: 7 })));
  return element("ul", { class: "legend-list" }, ...outcomes, ...heights);
}

// Hatches, by which outcomes can be told without colours.
function patterns() {
  const tile = (id, size, ...content) => drawing("pattern", {
    id: `outcome-${id}`, width: size, height: size, patternUnits: "userSpaceOnUse",
  }, drawing("rect", { class: `tile-${id}`, width: size, height: size }), ...content);
  return drawing("defs", {},
    tile("topple", 6, drawing("path", { class: "hatch", d: "M-1,1 l2,-2 M0,6 l6,-6 M5,7 l2,-2" })),
    tile("undecided", 5, drawing("circle", { class: "dot", cx: 2.5, cy: 2.5, r: 1 })));
}

function round(length) {
  return Math.round(1e5 * length) / 1e5;
}
