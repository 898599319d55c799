// Marks on the table in 3-D: heights on an object, lengths, and things as they would be tipped.

import * as THREE from "/viewer/vendor/three.module.min.js";
import { geometryOf } from "/viewer/body_shapes.js";
import { ghostOf } from "/viewer/force_markers.js";

export const COLOURS = {
  topples: 0xd55e00, slides: 0x0072b2, asked: 0xb8101d, reach: 0x56606b, free: 0x0072b2,
};
const UP = new THREE.Vector3(0, 0, 1);
const LINE = 0.0032; // thickness of lines [m]
const RIM = 0.022; // by which the plane of a height stands out [m]
const BEYOND = 0.5; // most of what is asked that is drawn beyond what is there [m]

// Box about the shapes of a body, in its frame.
export function boundsOf(body) {
  const bounds = new THREE.Box3();
  for (const shape of body.shapes) {
    if (shape.kind === "label" || shape.kind === "tube") continue;
    const [w, x, y, z, ...place] = shape.pose;
    const geometry = geometryOf(shape).applyQuaternion(new THREE.Quaternion(x, y, z, w));
    geometry.translate(...place).computeBoundingBox();
    bounds.union(geometry.boundingBox);
    geometry.dispose();
  }
  return bounds;
}

// A line about a body at a height, and a plane there; in the body's frame.
export function heightMark(body, height, colour) {
  const bounds = boundsOf(body);
  const size = bounds.getSize(new THREE.Vector3());
  const middle = bounds.getCenter(new THREE.Vector3()).setZ(height);
  const group = new THREE.Group();
  const round = body.shapes.some(({ kind }) => kind === "lathe" || kind === "cylinder");
  const sheet = round
    ? new THREE.CircleGeometry(size.x / 2 + RIM, 40)
    : new THREE.PlaneGeometry(size.x + 2 * RIM, size.y + 2 * RIM);
  group.add(new THREE.Mesh(sheet, flat(colour, 0.2)));
  if (round) group.add(new THREE.Mesh(new THREE.TorusGeometry(size.x / 2, LINE / 2, 6, 48), flat(colour)));
  else {
    for (const side of [-0.5, 0.5]) {
      group.add(
        bar(size.x + LINE, [0, side * size.y, 0], 0, colour),
        bar(size.y + LINE, [side * size.x, 0, 0], Math.PI / 2, colour),
      );
    }
  }
  group.position.copy(middle);
  return group;
}

// A length from one point to another, and what of the asked one is beyond it.
export function lengthMark({ start_W: start, end_W: end, asked }) {
  const group = new THREE.Group();
  const along = new THREE.Vector3(...end).sub(new THREE.Vector3(...start));
  const length = along.length();
  const heading = Math.atan2(along.y, along.x);
  group.position.set(start[0], start[1], Math.max(start[2], LINE));
  group.rotation.z = heading;
  group.add(
    bar(length, [length / 2, 0, 0], 0, COLOURS.free),
    ...[0, length].map((x) => bar(0.03, [x, 0, 0], Math.PI / 2, COLOURS.free)),
  );
  const beyond = Math.min((asked ?? 0) - length, BEYOND);
  for (let x = length + 0.01; x < length + beyond; x += 0.03) {
    group.add(bar(0.02, [x + 0.01, 0, 0], 0, COLOURS.asked));
  }
  return onTop(group);
}

// A body tipped from a pose about an edge of its base.
export function tiltMark(body, pose, { edge_W: edge, axis_W: axis, angle }) {
  const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(...axis), angle);
  const [w, x, y, z, ...place] = pose;
  const pivot = new THREE.Vector3(...edge);
  const moved = new THREE.Vector3(...place).sub(pivot).applyQuaternion(turn).add(pivot);
  const turned = turn.multiply(new THREE.Quaternion(x, y, z, w));
  const there = [turned.w, turned.x, turned.y, turned.z, ...moved.toArray()];
  return ghostOf(body, there, COLOURS.topples);
}

// A pose on the table as a row: quaternion (w, x, y, z) and place.
export function poseOf({ x, y, yaw }) {
  return [Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2), x, y, 0];
}

// The corners of a body at a height, in W.
export function cornersAt(body, pose, height) {
  const { min, max } = boundsOf(body);
  return [[min.x, min.y], [min.x, max.y], [max.x, min.y], [max.x, max.y]].map(([x, y]) =>
    inWorld(pose, [x, y, height]));
}

// A point of a body's frame in W.
export function inWorld([w, x, y, z, ...place], point) {
  return new THREE.Vector3(...point)
    .applyQuaternion(new THREE.Quaternion(x, y, z, w)).add(new THREE.Vector3(...place));
}

function flat(color, opacity = 1) {
  return new THREE.MeshBasicMaterial({
    color, opacity, transparent: true, depthWrite: opacity === 1, side: THREE.DoubleSide,
  });
}

function bar(length, middle, heading, colour) {
  const made = new THREE.Mesh(new THREE.BoxGeometry(length, LINE, LINE), flat(colour));
  made.position.set(...middle);
  made.rotateOnAxis(UP, heading);
  return made;
}

// Seen through whatever stands before it.
function onTop(group) {
  group.traverse((part) => {
    if (part.material) Object.assign(part.material, { depthTest: false });
    part.renderOrder = 4;
  });
  return group;
}
