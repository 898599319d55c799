// Plays frames in a viewer: recorded ones with a clock of their own, or live ones as they come.

import { Vector3 } from "./vendor/three.module.min.js";
import { FrameTrack, bytesOf, series } from "./frame_track.js";

const NEAR = 0.8; // share of the distance from which a contact is looked at
const FAR = 1.6; // the same, of the whole table with the arm over it
const OVERVIEW = new Vector3(0, 0, 0.3); // from the table to what is looked at then [m]
const MIDDLE = 0.3; // how much of the table stays the place that is looked at
const FELT = 0.25; // force from which a finger is shown to press [N]
const LAG = 0.25; // of a live view, so that it can interpolate [s]
const LATEST = 1; // lag that is let go instead of being made up for [s]
const HURRY = 3; // by which a live view is the faster, the later it is [1/s]

class Player {
  shares = false; // whether what is shown is being worked out

  constructor(viewer, track) {
    this.viewer = viewer;
    this.track = track;
    this.poses = new Float32Array(7 * viewer.document.bodies.length);
    this.listeners = [];
    this.take();
  }

  // Moves the bodies from now on, and nobody else does.
  take() {
    this.viewer.onframe = (now) => this.tick(now);
    this.viewer.shares = this.shares;
    this.viewer.invalidate();
  }

  // `listener` is called with the time [s] and the frame after each that was shown.
  onshow(listener) {
    this.listeners.push(listener);
  }

  show(time) {
    const frame = this.track.read(time, this.poses);
    this.viewer.setPoses(this.poses);
    return frame;
  }

  // Looks at the contact, and at a body where there is none; `fingers` have places and forces.
  look(index, fingers) {
    const pressing = fingers.filter(({ force }) => Math.hypot(...force) > 0);
    const k = 7 * index + 4;
    const place = new Vector3(this.poses[k], this.poses[k + 1], this.poses[k + 2] + 0.1);
    if (pressing.length) place.set(0, 0, 0);
    for (const finger of pressing) place.addScaledVector(new Vector3(...finger.place), 1 / pressing.length);
    const { home } = this.viewer.orbit;
    place.lerp(new Vector3(...home.at), MIDDLE);
    this.viewer.orbit.follow(place, home.distance * (pressing.length ? NEAR : 1));
  }

  told(time, frame) {
    for (const listener of this.listeners) listener(time, frame);
  }
}

// A recording of `sim.views.viewer_recording`.
export class RecordingPlayer extends Player {
  constructor(viewer, recording) {
    super(viewer, FrameTrack.ofRecording(recording));
    this.recording = recording;
    this.fingers = recording.fingers.map((finger) => ({
      places: series(finger.places), forces: series(finger.forces),
    }));
    this.forms = recording.liquid.map((form) => decoded(form));
    this.time = this.track.start;
    this.speed = 1;
    this.playing = false;
    this.seek(this.time);
  }

  get end() {
    return this.track.end;
  }

  play() {
    if (this.time >= this.end) this.seek(0);
    this.playing = true;
    this.before = null;
    this.viewer.invalidate();
    this.told(this.time, this.frame);
  }

  pause() {
    this.playing = false;
    this.told(this.time, this.frame);
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.track.start), this.end);
    const frame = (this.frame = this.show(this.time));
    this.viewer.setLiquid(this.forms.filter((form) => form.from <= frame && frame <= form.to));
    const fingers = this.fingers.map(({ places, forces }) => ({
      place: places[frame], force: forces[frame],
    }));
    this.viewer.setFingers(fingers);
    this.look(this.recording.pushed, fingers);
    this.told(this.time, frame);
  }

  tick(now) {
    if (!this.playing) return false;
    const passed = this.before === null ? 0 : Math.min((now - this.before) / 1e3, 0.25);
    this.before = now;
    this.seek(this.time + this.speed * passed);
    if (this.time >= this.end) this.pause();
    return this.playing;
  }
}

function decoded(form) {
  const steps = new Int16Array(bytesOf(form.corners).buffer);
  const faces = new Uint16Array(bytesOf(form.faces).buffer);
  const corners = Float32Array.from(steps, (each) => each * form.step);
  return { body: form.body, from: form.from, to: form.to, corners, faces };
}

// Frames that are pushed while they happen; shown a little later, so that they are smooth.
export class LivePlayer extends Player {
  constructor(viewer) {
    super(viewer, new FrameTrack());
    this.shares = true;
    this.take();
    this.follow(null);
  }

  // Looks at an object from now on, which is pushed along a direction; at the table without one.
  follow(object, along = [0, 0, 0]) {
    Object.assign(this, { object, along, felt: {}, fingers: [] });
    this.viewer.setFingers([]);
    if (object !== null) return;
    const { home } = this.viewer.orbit;
    this.viewer.orbit.follow(new Vector3(...home.at).add(OVERVIEW), FAR * home.distance);
  }

  // Shows what fingers feel [N], by their names.
  feel(forces) {
    this.felt = forces;
    this.viewer.invalidate();
  }

  // `{time, poses}`: time [s], poses by the names of the bodies as the service tells them. A body
  // that is not told of stays where it was.
  push({ time, poses }) {
    const row = this.newest ? this.newest.slice() : restingPoses(this.viewer.document.bodies);
    this.viewer.document.bodies.forEach(({ name }, i) => {
      if (poses[name]) row.set(poses[name], 7 * i);
    });
    this.newest = row;
    if (time <= this.track.end) this.track = new FrameTrack(); // put back to its beginning
    if (!this.track.times.length) this.time = time;
    this.track.push(time, row, 120);
    this.viewer.invalidate();
  }

  tick(now) {
    if (!this.track.times.length) return false;
    const passed = this.before ? Math.min((now - this.before) / 1e3, 0.25) : 0;
    const late = this.track.end - this.time;
    const speed = Math.max(0.25, 1 + HURRY * (late - LAG));
    const time = late > LATEST ? this.track.end - LAG : this.time + speed * passed;
    this.time = Math.min(Math.max(time, this.track.start), this.track.end);
    const moves = this.time < this.track.end;
    this.before = moves ? now : null;
    const frame = this.show(this.time);
    if (this.object !== null) this.#showForces();
    this.told(this.time, frame);
    return moves;
  }

  #showForces() {
    this.fingers = Object.entries(this.felt).filter(([, newtons]) => newtons > FELT)
      .map(([finger, newtons]) => ({
        place: this.#tipOf(finger), force: this.along.map((part) => part * newtons),
      }))
      .filter(({ place }) => place);
    this.viewer.setFingers(this.fingers);
    const index = this.viewer.indexOf(this.object);
    if (index >= 0) this.look(index, this.fingers);
  }

  // Place of a fingertip in W: the middle of the last shape of its body.
  #tipOf(finger) {
    const { bodies } = this.viewer.document;
    const index = bodies.findIndex(({ kind, name }) => kind === "robot" && name.endsWith(`/${finger}_tip`));
    if (index < 0) return null;
    const bone = this.viewer.bodies[index];
    const [, , , , ...place] = bodies[index].shapes.at(-1).pose;
    return new Vector3(...place).applyQuaternion(bone.quaternion).add(bone.position).toArray();
  }
}

function restingPoses(bodies) {
  const row = new Float32Array(7 * bodies.length);
  bodies.forEach((_, i) => (row[7 * i] = 1));
  return row;
}
