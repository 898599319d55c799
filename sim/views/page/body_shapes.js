// Shapes of a scene document as meshes.

import * as THREE from "./vendor/three.module.min.js";

const BEVEL = 0.0022; // of edges, which catch the light [m]

// The bodies of a scene: a bone for each, and the meshes that move with them. What is solid is one
// mesh for the robot and one for the rest, since each mesh more costs time in every frame.
export function meshesOf(bodies) {
  const bones = bodies.map((body) => Object.assign(new THREE.Bone(), { name: body.name }));
  const skeleton = new THREE.Skeleton(bones, bones.map(() => new THREE.Matrix4()));
  const [robot, rest, labels] = [new SolidParts(), new SolidParts(), new SolidParts()];
  const sheet = new LabelSheet(bodies);
  bodies.forEach((body, index) => {
    for (const shape of body.shapes) {
      if (shape.kind === "grid") bones[index].add(gridOf(shape));
      else if (shape.kind === "label") labels.add(shape, index, sheet.corners(shape));
      else if (shape.colour[3] < 1) bones[index].add(shellOf(shape));
      else (body.kind === "robot" ? robot : rest).add(shape, index);
    }
  });
  const shiny = new THREE.MeshPhongMaterial({ vertexColors: true, specular: 0x3a3a3a, shininess: 42 });
  const matt = new THREE.MeshLambertMaterial({ vertexColors: true });
  const printed = new THREE.MeshLambertMaterial({
    map: sheet.texture, polygonOffset: true, polygonOffsetUnits: -8,
  });
  const meshes = [[robot, shiny], [rest, matt], [labels, printed]]
    .filter(([parts]) => parts.values.position.length)
    .map(([parts, material]) => parts.mesh(material, skeleton));
  return { bones, meshes };
}

// Solid shapes of several bodies as one geometry, whose corners know their body.
class SolidParts {
  constructor() {
    this.values = { position: [], normal: [], color: [], uv: [], skinIndex: [], skinWeight: [] };
    this.faces = [];
  }

  // `corners` of a sheet are the place of a label on it.
  add(shape, index, corners = null) {
    const geometry = placed(geometryOf(shape, index), shape.pose);
    const { position, normal, uv } = geometry.attributes;
    const first = this.values.position.length / 3;
    const faces = geometry.index?.array ?? Array.from({ length: position.count }, (_, i) => i);
    for (const corner of faces) this.faces.push(first + corner);
    const [r, g, b] = new THREE.Color().setRGB(...shape.colour.slice(0, 3), THREE.SRGBColorSpace);
    for (const [name, { array }] of Object.entries({ position, normal })) {
      for (const value of array) this.values[name].push(value);
    }
    for (let i = 0; i < position.count; i++) {
      this.values.color.push(r, g, b);
      this.values.skinIndex.push(index, 0, 0, 0);
      this.values.skinWeight.push(1, 0, 0, 0);
      if (!corners) continue;
      const [left, low, width, height] = corners;
      this.values.uv.push(left + width * uv.getX(i), low + height * uv.getY(i));
    }
  }

  mesh(material, skeleton) {
    const geometry = new THREE.BufferGeometry();
    const { skinIndex, ...floats } = this.values;
    for (const [name, values] of Object.entries(floats)) {
      const size = { skinWeight: 4, uv: 2 }[name] ?? 3;
      if (values.length) geometry.setAttribute(name, new THREE.Float32BufferAttribute(values, size));
    }
    geometry.setAttribute("skinIndex", new THREE.Uint16BufferAttribute(skinIndex, 4));
    geometry.setIndex(this.faces);
    const mesh = new THREE.SkinnedMesh(geometry, material);
    mesh.bind(skeleton, new THREE.Matrix4());
    mesh.frustumCulled = false;
    mesh.boundingSphere = new THREE.Sphere(); // which would be found corner by corner
    mesh.castShadow = mesh.receiveShadow = true;
    return mesh;
  }
}

function placed(geometry, [w, x, y, z, ...place]) {
  return geometry.applyQuaternion(new THREE.Quaternion(x, y, z, w)).translate(...place);
}

// What one looks through.
function shellOf(shape) {
  const [r, g, b, opacity] = shape.colour;
  const material = new THREE.MeshLambertMaterial({
    color: new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace),
    transparent: true, opacity, depthWrite: false, forceSinglePass: true,
    side: shape.kind === "lathe" ? THREE.DoubleSide : THREE.FrontSide,
  });
  const mesh = new THREE.Mesh(placed(geometryOf(shape), shape.pose), material);
  mesh.castShadow = true;
  mesh.renderOrder = 2;
  return mesh;
}

// How many sides something round has.
function sidesOf(radius) {
  return Math.round(Math.min(34, 8 + 420 * radius));
}

// Geometry of a shape in its own frame. Round bodies, of which one ends in the next, differ a little
// in radius by their place in the scene, so that their surfaces do not stripe.
export function geometryOf(shape, order = 0) {
  const swell = 1 + 0.035 * (order % 2);
  const sides = sidesOf(shape.radius);
  switch (shape.kind) {
    case "box":
      return boxGeometry(shape.size);
    case "sphere":
      return new THREE.SphereGeometry(shape.radius * swell, sides, Math.ceil(sides / 2));
    case "capsule":
      return new THREE.CapsuleGeometry(shape.radius * swell, shape.length, Math.ceil(sides / 5), sides)
        .rotateX(Math.PI / 2);
    case "cylinder":
      return cylinderGeometry(shape.radius, shape.length);
    case "lathe":
      return latheGeometry(shape.profile);
    case "tube": {
      const points = shape.points.map((p) => new THREE.Vector3(...p));
      return new THREE.TubeGeometry(new THREE.CatmullRomCurve3(points), 16, shape.radius, 10);
    }
    case "label":
      return new THREE.PlaneGeometry(...shape.size);
    default: {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(shape.corners, 3));
      geometry.setIndex(shape.faces);
      const flat = geometry.toNonIndexed();
      flat.computeVertexNormals();
      return flat;
    }
  }
}

function boxGeometry([x, y, z]) {
  const bevel = Math.min(BEVEL, 0.2 * Math.min(x, y, z));
  const [a, b] = [x / 2 - bevel, y / 2 - bevel];
  const outline = new THREE.Shape();
  outline.moveTo(-a, -b).lineTo(a, -b).lineTo(a, b).lineTo(-a, b).closePath();
  return new THREE.ExtrudeGeometry(outline, {
    depth: z - 2 * bevel, bevelEnabled: true, bevelSize: bevel, bevelThickness: bevel,
    bevelSegments: 1, curveSegments: 1,
  }).translate(0, 0, -z / 2 + bevel);
}

function cylinderGeometry(radius, length) {
  const bevel = Math.min(BEVEL, 0.2 * radius, 0.2 * length);
  const h = length / 2;
  return latheGeometry([
    [0, -h], [radius - bevel, -h], [radius, -h + bevel],
    [radius, h - bevel], [radius - bevel, h], [0, h],
  ]);
}

// Each piece of the profile has normals of its own, so that edges stay edges.
function latheGeometry(profile) {
  const positions = [];
  const normals = [];
  const faces = [];
  const sides = sidesOf(Math.max(...profile.map(([r]) => r)));
  for (let i = 0; i + 1 < profile.length; i++) {
    const [[r0, z0], [r1, z1]] = [profile[i], profile[i + 1]];
    const length = Math.hypot(r1 - r0, z1 - z0) || 1;
    const [out, up] = [(z1 - z0) / length, -(r1 - r0) / length];
    for (let k = 0; k <= sides; k++) {
      const phi = (2 * Math.PI * k) / sides;
      const [cos, sin] = [Math.cos(phi), Math.sin(phi)];
      positions.push(r0 * cos, r0 * sin, z0, r1 * cos, r1 * sin, z1);
      normals.push(out * cos, out * sin, up, out * cos, out * sin, up);
      if (k === sides) continue;
      const at = 2 * (i * (sides + 1) + k);
      faces.push(at, at + 2, at + 3, at, at + 3, at + 1);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.Float32BufferAttribute(normals, 3));
  geometry.setIndex(faces);
  return geometry;
}

// Lines on the table, one cell apart.
function gridOf({ size: [x, y], cell, pose, colour: [r, g, b, opacity] }) {
  const points = [];
  const line = (...ends) => points.push(...ends);
  for (let i = Math.ceil(-x / 2 / cell); i * cell <= x / 2; i++) line(i * cell, -y / 2, 0, i * cell, y / 2, 0);
  for (let i = Math.ceil(-y / 2 / cell); i * cell <= y / 2; i++) line(-x / 2, i * cell, 0, x / 2, i * cell, 0);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({
    color: new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace), transparent: true, opacity,
  }));
  lines.position.set(...pose.slice(4));
  return lines;
}

const CELL = 256; // of a sheet of labels [px]
const ROW = 4; // cells in a row

// All labels of a scene on one sheet. The text is drawn, never read as anything else.
class LabelSheet {
  constructor(bodies) {
    const labels = bodies.flatMap((body) => body.shapes.filter((shape) => shape.kind === "label"));
    this.cells = new Map();
    for (const label of labels) {
      if (!this.cells.has(cellKey(label))) this.cells.set(cellKey(label), [this.cells.size, label]);
    }
    const rows = Math.max(1, Math.ceil(this.cells.size / ROW));
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [ROW * CELL, rows * CELL];
    for (const [at, label] of this.cells.values()) {
      drawLabel(canvas.getContext("2d"), (at % ROW) * CELL, Math.floor(at / ROW) * CELL, label);
    }
    this.rows = rows;
    this.texture = new THREE.CanvasTexture(canvas);
    this.texture.colorSpace = THREE.SRGBColorSpace;
    this.texture.anisotropy = 4;
  }

  // Left, low, width and height of a label, as shares of the sheet.
  corners(label) {
    const [at] = this.cells.get(cellKey(label));
    const row = Math.floor(at / ROW);
    return [(at % ROW) / ROW, 1 - (row + 1) / this.rows, 1 / ROW, 1 / this.rows];
  }
}

function cellKey({ text, size }) {
  return `${size} ${text}`;
}

// A label fills a square of the sheet, and is stretched to its own size on the body.
function drawLabel(pen, x, y, { text, size }) {
  const high = CELL * Math.min(2, size[1] / size[0]);
  pen.save();
  pen.translate(x, y);
  pen.scale(1, CELL / high);
  pen.fillStyle = "#f7f4ea";
  pen.fillRect(0, 0, CELL, high);
  pen.strokeStyle = "#33302a";
  pen.lineWidth = 5;
  pen.strokeRect(9, 9, CELL - 18, high - 18);
  pen.fillStyle = "#26231e";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  const lines = text.slice(0, 36).split(/\s+/).slice(0, 4);
  let letters = Math.min(78, (high - 40) / lines.length / 1.15);
  const font = () => (pen.font = `700 ${letters}px system-ui, sans-serif`);
  font();
  const widest = Math.max(...lines.map((line) => pen.measureText(line).width), 1);
  letters *= Math.min(1, (CELL - 44) / widest);
  font();
  lines.forEach((line, i) => {
    pen.fillText(line, CELL / 2, high / 2 + (i - (lines.length - 1) / 2) * letters * 1.15);
  });
  pen.restore();
}
