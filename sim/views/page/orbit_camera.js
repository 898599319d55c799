// A camera that follows a place gently, and that a hand may turn, shift and bring nearer.

import * as THREE from "./vendor/three.module.min.js";

const FOLLOWS = 0.9; // time in which it has followed two thirds of the way [s]
const TURNS = 0.006; // per pixel [rad]
const NEAREST = 0.25;
const FARTHEST = 5;
const KEYS = {
  ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08],
};

export class OrbitCamera {
  constructor(canvas, changed) {
    this.camera = new THREE.PerspectiveCamera(29, 1, 0.05, 30);
    this.camera.up.set(0, 0, 1);
    this.changed = changed;
    this.home = { azimuth: -2.2, elevation: 0.42, distance: 1.75, at: [0.45, 0, 0.1] };
    this.wanted = new THREE.Vector3(...this.home.at);
    this.wantedDistance = this.home.distance;
    this.follows = true;
    this.pointers = new Map();
    this.reset();
    this.jump();
    this.#listen(canvas);
  }

  // Where it looks from as long as nobody turns it.
  setHome(home) {
    Object.assign(this.home, home);
    this.wantedDistance = this.home.distance;
    this.reset();
    this.jump();
  }

  reset() {
    this.azimuth = this.home.azimuth;
    this.elevation = this.home.elevation;
    this.zoom = 1;
    this.shift = new THREE.Vector3();
    this.follows = true;
    this.changed();
  }

  // What it follows, and from how far.
  follow(place, distance = this.home.distance) {
    if (!this.follows) return;
    this.wanted.copy(place);
    this.wantedDistance = distance;
  }

  // Looks at once where it would have arrived.
  jump() {
    this.at = this.wanted.clone();
    this.distance = this.wantedDistance;
  }

  // One step of time [s]; true while it still moves.
  update(step) {
    const share = 1 - Math.exp(-step / FOLLOWS);
    const off = this.at.distanceTo(this.wanted) + Math.abs(this.distance - this.wantedDistance);
    this.at.lerp(this.wanted, share);
    this.distance += share * (this.wantedDistance - this.distance);
    const far = this.distance * this.zoom * this.#narrowness();
    const target = this.at.clone().add(this.shift);
    const level = far * Math.cos(this.elevation);
    this.camera.position.set(
      target.x + level * Math.cos(this.azimuth),
      target.y + level * Math.sin(this.azimuth),
      target.z + far * Math.sin(this.elevation),
    );
    this.camera.lookAt(target);
    return off > 1e-4;
  }

  // A narrow view is taken from farther away.
  #narrowness() {
    return Math.max(1, Math.min(1.45, 1.15 / this.camera.aspect));
  }

  turn(right, up) {
    this.azimuth -= right;
    this.elevation = Math.min(1.5, Math.max(-0.1, this.elevation + up));
    this.changed();
  }

  approach(factor) {
    const far = this.distance * this.zoom * factor;
    this.zoom *= Math.min(FARTHEST, Math.max(NEAREST, far)) / far * factor;
    this.changed();
  }

  pan(x, y) {
    const scale = (this.distance * this.zoom) / 900;
    const side = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 0);
    const up = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 1);
    this.shift.addScaledVector(side, -x * scale).addScaledVector(up, y * scale);
    this.shift.clampLength(0, 1.5);
    this.changed();
  }

  #listen(canvas) {
    canvas.style.touchAction = "none";
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    }
    canvas.addEventListener("pointermove", (event) => this.#drag(event));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.approach(Math.exp(0.0012 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("keydown", (event) => {
      const turn = KEYS[event.key];
      if (!turn || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopPropagation();
      this.turn(...turn);
    });
  }

  #drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const spread = () => {
      const [[a, b], [c, d]] = [...this.pointers.values()];
      return Math.hypot(c - a, d - b);
    };
    const pinched = this.pointers.size === 2 ? spread() : 0;
    const [x, y] = [event.clientX - before[0], event.clientY - before[1]];
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pinched) {
      this.approach(pinched / Math.max(spread(), 1));
      this.pan(x / 2, y / 2);
    } else if (event.shiftKey || event.buttons === 2) this.pan(x, y);
    else this.turn(TURNS * x, TURNS * y);
  }
}
