// The 3-D view of a table: draws a scene document, and the frames that it is told.

import * as THREE from "./vendor/three.module.min.js";
import { meshesOf } from "./body_shapes.js";
import { ForceArrow, contactRing, ghostOf } from "./force_markers.js";
import { OrbitCamera } from "./orbit_camera.js";
import { DrawingFence, RenderQuality, newRenderer } from "./render_quality.js";

const SETTLES = 250; // after which what does not move is drawn finely [ms]
const LONGEST_REST = 100; // between two frames of what happens now [ms]
const THEMES = {
  light: { sky: 0xe9eef3, floor: 0xd9dfe5, hemisphere: 2.05, sun: 2.1 },
  dark: { sky: 0x14181d, floor: 0x23292f, hemisphere: 0.95, sun: 1.75 },
};

export class Viewer {
  // `holder` is the element to fill, `scene` a document of `sim.views.viewer_recording`.
  constructor(holder, scene) {
    this.holder = holder;
    this.document = scene;
    const { renderer, software } = newRenderer();
    this.renderer = renderer;
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The table in 3-D. Arrow keys turn the view.");
    holder.append(this.canvas);
    this.scene = new THREE.Scene();
    this.orbit = new OrbitCamera(this.canvas, () => this.invalidate());
    this.#light();
    this.quality = new RenderQuality(this.renderer, this.sun, { software });
    const { bones, meshes } = meshesOf(scene.bodies);
    this.bodies = bones;
    this.scene.add(...bones, ...meshes);
    this.liquid = new THREE.Group();
    this.arrows = [];
    this.ghosts = new THREE.Group();
    this.rings = [];
    this.scene.add(this.liquid, this.ghosts);
    this.onframe = null; // is asked for each frame, with its time [ms]; true if things move
    this.ondrawn = null; // is called after each frame, when the camera stands where it is
    this.shares = false; // whether what is shown is being worked out on this machine, or may be
    this.took = null; // the last frame, until it was drawn [ms]
    this.scriptTime = 0; // of the last frame [ms]
    this.frames = 0;
    this.size = [1, 1];
    this.fence = new DrawingFence(this.renderer);
    this.#follow();
    this.#compile();
  }

  // Nothing moves before its programs are there, so that no frame has to wait for them.
  async #compile() {
    const marks = [new ForceArrow().group, contactRing({ place: [0, 0, 0], normal: [0, 0, 1] })];
    this.scene.add(...marks);
    this.quality.apply(false); // later it would wait for the programs
    await this.renderer.compileAsync(this.scene, this.orbit.camera);
    this.scene.remove(...marks);
    if (this.ended) return;
    this.orbit.update(0);
    this.#draw(); // takes the programs of shadows with it
    this.compiled = true;
    this.invalidate();
  }

  // -- what is shown ------------------------------------------------------------------------------

  // Poses of all bodies, seven numbers each: quaternion (w, x, y, z) and place.
  setPoses(poses) {
    this.bodies.forEach((body, i) => {
      const k = 7 * i;
      body.quaternion.set(poses[k + 1], poses[k + 2], poses[k + 3], poses[k]).normalize();
      body.position.set(poses[k + 4], poses[k + 5], poses[k + 6]);
    });
    this.invalidate();
  }

  // Forms of liquid, `{body, corners, faces}` each; the same object keeps its mesh.
  setLiquid(forms) {
    const [r, g, b, opacity] = this.document.liquid;
    const wanted = new Set(forms);
    for (const mesh of [...this.liquid.children]) {
      if (wanted.delete(mesh.userData.form)) continue;
      mesh.geometry.dispose();
      this.liquid.remove(mesh);
    }
    this.liquidMaterial ??= new THREE.MeshLambertMaterial({
      color: new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace), opacity,
      transparent: opacity < 1, flatShading: true, side: THREE.DoubleSide,
    });
    for (const form of wanted) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(form.corners, 3));
      geometry.setIndex(new THREE.Uint16BufferAttribute(form.faces, 1));
      const mesh = new THREE.Mesh(geometry, this.liquidMaterial);
      mesh.userData.form = form;
      mesh.matrixAutoUpdate = false;
      this.liquid.add(mesh);
    }
    for (const mesh of this.liquid.children) {
      const body = this.bodies[mesh.userData.form.body];
      if (body) {
        body.updateMatrix();
        mesh.matrix.copy(body.matrix);
      }
    }
    this.invalidate();
  }

  // Fingertips and their forces on the object, `{place, force}` each [m], [N].
  setFingers(fingers) {
    while (this.arrows.length < fingers.length) {
      const arrow = new ForceArrow();
      this.arrows.push(arrow);
      this.scene.add(arrow.group);
    }
    this.arrows.forEach((arrow, i) => {
      if (fingers[i]) arrow.show(fingers[i].place, fingers[i].force);
      else arrow.group.visible = false;
    });
    this.invalidate();
  }

  // Objects as they should be at the end, `{name, pose}` each.
  setGhosts(ghosts) {
    this.ghosts.clear();
    for (const { name, pose } of ghosts) {
      const body = this.document.bodies[this.indexOf(name)];
      if (body) this.ghosts.add(ghostOf(body, pose));
    }
    this.invalidate();
  }

  // Places where objects are to be touched, `{name, place, normal}` each, in the object's frame.
  setContacts(contacts) {
    for (const ring of this.rings) ring.removeFromParent();
    this.rings = contacts.map((contact) => {
      const ring = contactRing(contact);
      this.bodies[this.indexOf(contact.name)]?.add(ring);
      return ring;
    });
    this.invalidate();
  }

  // Place of an object among the bodies.
  indexOf(object) {
    return this.document.bodies.findIndex((each) => each.object === object && each.kind === "object");
  }

  // Place of a point of W in the element [px]; null behind the eye.
  project(place) {
    const seen = place.clone().project(this.orbit.camera);
    if (seen.z > 1) return null;
    const [width, height] = this.size;
    return [((seen.x + 1) / 2) * width, ((1 - seen.y) / 2) * height];
  }

  // -- frames -------------------------------------------------------------------------------------

  invalidate() {
    if (this.waiting || this.ended || !this.compiled) return;
    this.waiting = requestAnimationFrame((now) => this.#frame(now));
  }

  #frame(now) {
    const began = performance.now();
    if (!this.fence.isDown || this.#rests(now)) {
      this.waiting = requestAnimationFrame((later) => this.#frame(later));
      return;
    }
    clearTimeout(this.settling);
    const moves = this.onframe ? this.onframe(now) : false;
    const step = this.last ? Math.min((now - this.last) / 1e3, 0.1) : 0;
    if (moves && this.moved) this.quality.feel(this.took / 1e3);
    this.took = null;
    this.moved = moves;
    this.last = now;
    const glides = this.orbit.update(step);
    this.quality.apply(false);
    this.#draw();
    this.ondrawn?.();
    this.frames++;
    this.scriptTime = performance.now() - began;
    this.waiting = null; // what was put in place by this frame asks for no further one
    if (moves || glides) this.invalidate();
    else this.settling = setTimeout(() => this.#settle(), SETTLES);
  }

  // True while it is left to others what the last frame took. Who draws in software takes the
  // processor from the simulation that is being watched.
  #rests(now) {
    this.took ??= this.last ? now - this.last : 0;
    const rest = this.shares && this.quality.software ? Math.min(this.took, LONGEST_REST) : 0;
    return now < this.last + this.took + rest;
  }

  // Draws what does not move once more, finely.
  #settle() {
    if (!this.fence.isDown) {
      this.settling = setTimeout(() => this.#settle(), SETTLES);
      return;
    }
    this.last = null;
    this.quality.apply(true);
    this.#draw();
    this.holder.dataset.settled = String(this.frames);
  }

  #draw() {
    this.renderer.render(this.scene, this.orbit.camera);
    this.fence.raise();
  }

  dispose() {
    this.ended = true;
    cancelAnimationFrame(this.waiting);
    clearTimeout(this.settling);
    this.watcher.disconnect();
    this.renderer.dispose();
    this.canvas.remove();
  }

  // -- light and size -----------------------------------------------------------------------------

  #light() {
    this.hemisphere = new THREE.HemisphereLight(0xffffff, 0xb9a994, 1);
    this.sun = new THREE.DirectionalLight(0xfff4e6, 1);
    this.sun.position.set(-0.35, -1.35, 2.1);
    this.sun.target.position.set(0.5, 0, 0);
    const { camera } = this.sun.shadow;
    Object.assign(camera, { left: -1.1, right: 1.1, top: 1.1, bottom: -1.1, near: 0.5, far: 5 });
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.004;
    this.sun.shadow.radius = 3;
    this.floor = new THREE.Mesh(
      new THREE.CircleGeometry(9, 48), new THREE.MeshLambertMaterial({ color: 0xffffff }),
    );
    this.floor.position.z = this.document.floor;
    this.floor.receiveShadow = true;
    this.scene.add(this.hemisphere, this.sun, this.sun.target, this.floor);
    this.scene.fog = new THREE.Fog(0xffffff, 3.2, 8);
  }

  // Follows the size of its element and the choice of light or dark.
  #follow() {
    const dark = matchMedia("(prefers-color-scheme: dark)");
    const choose = () => {
      const theme = THEMES[dark.matches ? "dark" : "light"];
      this.scene.background = new THREE.Color(theme.sky);
      this.scene.fog.color.set(theme.sky);
      this.floor.material.color.set(theme.floor);
      this.hemisphere.intensity = theme.hemisphere;
      this.sun.intensity = theme.sun;
      this.invalidate();
    };
    dark.addEventListener("change", choose);
    choose();
    const fit = () => {
      const { clientWidth, clientHeight } = this.holder;
      if (!clientWidth || !clientHeight) return;
      this.size = [clientWidth, clientHeight];
      this.renderer.setSize(clientWidth, clientHeight);
      this.orbit.camera.aspect = clientWidth / clientHeight;
      this.orbit.camera.updateProjectionMatrix();
      this.invalidate();
    };
    this.watcher = new ResizeObserver(fit);
    this.watcher.observe(this.holder);
    fit();
  }
}
