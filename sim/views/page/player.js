// Plays frames in a viewer: recorded ones with a clock of their own, or live ones as they come.

import { Vector3 } from "./vendor/three.module.min.js";
import { FrameTrack, bytesOf, series } from "./frame_track.js";

const NEAR = 0.8; // share of the distance from which a contact is looked at
const MIDDLE = 0.3; // how much of the table stays the place that is looked at
const LAG = 0.25; // of a live view, so that it can interpolate [s]
const LATEST = 1; // lag that is let go instead of being made up for [s]
const HURRY = 3; // by which a live view is the faster, the later it is [1/s]

class Player {
  constructor(viewer, track) {
    this.viewer = viewer;
    this.track = track;
    this.poses = new Float32Array(7 * viewer.document.bodies.length);
    this.listeners = [];
    viewer.onframe = (now) => this.tick(now);
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
    viewer.orbit.jump();
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
    this.#look(fingers.filter(({ force }) => Math.hypot(...force) > 0));
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

  // Looks at the contact, and at what is pushed where there is none.
  #look(pressing) {
    const k = 7 * this.recording.pushed + 4;
    const body = new Vector3(this.poses[k], this.poses[k + 1], this.poses[k + 2] + 0.1);
    const place = new Vector3();
    for (const finger of pressing) place.addScaledVector(new Vector3(...finger.place), 1 / pressing.length);
    if (!pressing.length) place.copy(body);
    const { home } = this.viewer.orbit;
    place.lerp(new Vector3(...home.at), MIDDLE);
    this.viewer.orbit.follow(place, home.distance * (pressing.length ? NEAR : 1));
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
    this.told(this.time, this.show(this.time));
    return moves;
  }
}

function restingPoses(bodies) {
  const row = new Float32Array(7 * bodies.length);
  bodies.forEach((_, i) => (row[7 * i] = 1));
  return row;
}
