// Marks of contact: where it is to be, the fingers' forces, and the predicted end pose.

import * as THREE from "./vendor/three.module.min.js";
import { geometryOf } from "./body_shapes.js";

const PRESS = 0xd6006c;
const GHOST = 0x1769c2;
const PER_NEWTON = 0.014; // length of an arrow [m/N]
const UP = new THREE.Vector3(0, 1, 0);

// An arrow that ends at a fingertip, seen through whatever is before it.
export class ForceArrow {
  constructor() {
    const material = new THREE.MeshBasicMaterial({
      color: PRESS, depthTest: false, transparent: true, opacity: 0.92,
    });
    this.group = new THREE.Group();
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.0035, 0.0035, 1, 10), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(0.0095, 0.022, 14), material);
    this.group.add(this.shaft, this.head);
    for (const part of this.group.children) part.renderOrder = 5;
    this.group.visible = false;
  }

  show(place, force) {
    const newtons = Math.hypot(...force);
    this.group.visible = newtons > 0;
    if (!newtons) return;
    const length = Math.min(0.13, 0.03 + PER_NEWTON * newtons);
    const along = new THREE.Vector3(...force).divideScalar(newtons);
    this.group.position.set(...place);
    this.group.quaternion.setFromUnitVectors(UP, along);
    this.head.position.y = -0.011;
    this.shaft.scale.y = length - 0.02;
    this.shaft.position.y = -0.02 - (length - 0.02) / 2;
  }
}

// A ring on a body where it is to be touched; `normal` points out of the body.
export function contactRing({ place, normal }) {
  const ring = new THREE.Mesh(
    new THREE.TorusGeometry(0.0135, 0.0022, 8, 32),
    new THREE.MeshBasicMaterial({ color: PRESS, transparent: true, opacity: 0.95 }),
  );
  ring.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(...normal));
  ring.position.set(...place).addScaledVector(new THREE.Vector3(...normal), 0.001);
  return ring;
}

// A body as it should be at the end, or may not be.
export function ghostOf(body, pose, colour = GHOST) {
  const group = new THREE.Group();
  const fill = new THREE.MeshBasicMaterial({
    color: colour, transparent: true, opacity: 0.13, depthWrite: false,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 8,
  });
  const line = new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity: 0.85 });
  for (const shape of body.shapes) {
    if (shape.kind === "label" || shape.kind === "tube") continue;
    const part = new THREE.Group();
    const [w, x, y, z, ...place] = shape.pose;
    part.quaternion.set(x, y, z, w);
    part.position.set(...place);
    part.scale.setScalar(1.004);
    const geometry = shape.kind === "box" ? new THREE.BoxGeometry(...shape.size) : geometryOf(shape);
    const mesh = new THREE.Mesh(geometry, fill);
    mesh.renderOrder = 3;
    part.add(mesh, new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 40), line));
    group.add(part);
  }
  const [w, x, y, z, ...place] = pose;
  group.quaternion.set(x, y, z, w);
  group.position.set(...place);
  return group;
}
