// The offer drawn on the table: contacts and forces, the end, and the numbers that stand in the way.

import * as THREE from "/viewer/vendor/three.module.min.js";
import { ForceArrow, ghostOf } from "/viewer/force_markers.js";
import { ViewLabels } from "./view_labels.js";
import {
  COLOURS, cornersAt, heightMark, inWorld, lengthMark, poseOf, tiltMark,
} from "./table_marks.js";
import { isUnderWay } from "../app_state.js";
import { millimetres, newtons } from "./quantities.js";

// Draws each offer in the viewer of the table; what is to be approved goes when it is carried out, and
// when the field says something else.
export function sketchOffers(state, view) {
  let sketch = null;
  let drawn = [];
  const draw = () => {
    const isDone = isUnderWay(state.get("run")) || Boolean(state.get("result"));
    const offer = isDone || state.isAsShown ? state.get("offer") : null;
    const wanted = [view.viewer, offer, isDone];
    if (wanted.every((each, i) => each === drawn[i])) return;
    drawn = wanted;
    sketch?.remove();
    sketch = null;
    const { drawing, result } = offer ?? {};
    if (!view.viewer) return;
    view.viewer.setGhosts(drawing?.ghosts ?? []);
    if (drawing && !isDone) sketch = new OfferSketch(view.viewer, drawing, result, state.get("table"));
  };
  view.addEventListener("viewer", draw);
  state.on(["offer", "run", "result", "text", "said"], draw);
}

class OfferSketch {
  #group = new THREE.Group();
  #notes = [];

  constructor(viewer, drawing, result, table) {
    Object.assign(this, { viewer, table });
    const step = result.steps.at(-1);
    this.pose = step?.before ? poseOf(step.before) : null;
    this.labels = new ViewLabels(viewer);
    viewer.setContacts(drawing.contacts);
    if (this.pose && step.plan) this.#plan(drawing, step.plan);
    for (const mark of drawing.marks) this.#mark(mark);
    viewer.scene.add(this.#group);
    this.labels.show(this.#notes);
    this.#look(drawing);
    viewer.invalidate();
  }

  remove() {
    this.#group.removeFromParent();
    this.#group.traverse((part) => part.geometry?.dispose());
    this.labels.remove();
    this.viewer.setContacts([]);
  }

  #body(name) {
    return this.viewer.document.bodies[this.viewer.indexOf(name)];
  }

  #poseOf(name) {
    const found = this.table?.objects.find((each) => each.name === name);
    return found ? poseOf(found) : null;
  }

  #plan({ contacts, ghosts }, plan) {
    const [first] = plan.actions;
    const tails = contacts.map((contact) => this.#arrow(contact, first, contacts.length));
    if (first.kind === "push") {
      this.#note(`at most ${newtons(first.force_limit)}`, "press", tails, "left");
      const { critical_height: height, outcome } = first.prediction;
      const [side, would, about] =
        outcome === "slide" ? ["above", "topple", "topples"] : ["below", "slide", "slides"];
      const text = `${side} ${millimetres(height)} it would ${would}`;
      if (height !== null) this.#height(plan.object, height, about, text);
    } else if (tails.length) this.#note(`held with ${newtons(first.squeeze)}`, "press", tails, "left");
    for (const { name, pose } of ghosts) {
      const body = this.#body(name);
      if (body) this.#note("predicted end", "end", [inWorld(pose, [0, 0, 0])]);
    }
  }

  // An arrow that ends at a contact; answers with where it begins.
  #arrow({ place, normal }, action, fingers) {
    const at = inWorld(this.pose, place);
    const [w, x, y, z] = this.pose;
    const inward = new THREE.Vector3(...normal).applyQuaternion(new THREE.Quaternion(x, y, z, w)).negate();
    const pushed = action.kind === "push";
    const along = pushed ? new THREE.Vector3(...action.direction_W) : inward;
    const force = pushed ? action.force_limit / fingers : action.squeeze;
    const arrow = new ForceArrow();
    arrow.show(at.toArray(), along.clone().multiplyScalar(force).toArray());
    this.#group.add(arrow.group);
    return at.addScaledVector(along, -0.1);
  }

  #mark(mark) {
    const body = mark.object && this.#body(mark.object);
    switch (mark.kind) {
      case "height":
        return this.#height(mark.object, mark.height, mark.about, mark.text);
      case "length": {
        this.#group.add(lengthMark(mark));
        const ends = [mark.start_W, mark.end_W].map((each) => new THREE.Vector3(...each));
        return this.#note(mark.text, "asked", [ends[0].lerp(ends[1], 0.5)]);
      }
      case "tilt":
        if (!body || !this.pose) return null;
        this.#group.add(tiltMark(body, this.pose, mark));
        return this.#note(mark.text, "topples", cornersAt(body, this.pose, 0));
      default: {
        const pose = body && this.#poseOf(mark.object);
        if (!pose) return null;
        this.#group.add(ghostOf(body, pose, COLOURS.asked));
        return this.#note(mark.text, "asked", cornersAt(body, pose, 0.06));
      }
    }
  }

  #height(name, height, about, text) {
    const body = this.#body(name);
    if (!body || !this.pose) return;
    const made = heightMark(body, height, COLOURS[about]);
    const [w, x, y, z, ...place] = this.pose;
    const holder = new THREE.Group();
    holder.quaternion.set(x, y, z, w);
    holder.position.set(...place);
    holder.add(made);
    this.#group.add(holder);
    this.#note(text, about, cornersAt(body, this.pose, height));
  }

  #note(text, about, places, side = "right") {
    this.#notes.push({ text, about, places, side });
  }

  // Looks at the object, and at where it should end.
  #look({ ghosts }) {
    if (!this.pose) return;
    const places = [this.pose, ...ghosts.map(({ pose }) => pose)].map((row) => new THREE.Vector3(...row.slice(4)));
    const middle = places.reduce((sum, each) => sum.add(each), new THREE.Vector3()).divideScalar(places.length);
    const wide = Math.max(...places.map((each) => each.distanceTo(middle)));
    this.viewer.orbit.follow(middle.setZ(middle.z + 0.1), 1.15 + 2 * wide);
  }
}
