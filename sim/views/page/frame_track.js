// Poses of bodies over time: kept frame by frame, read at any time in between.

const PART = 7; // quaternion (w, x, y, z) and place of a body

// Rows of differences of 16-bit integers, as `sim.views.viewer_recording.packed` writes them.
export function unpack({ step, rows, data }) {
  const found = new Int16Array(bytesOf(data).buffer);
  const length = rows ? found.length / rows : 0;
  for (let row = 0; row < rows; row++) {
    for (let i = row * length + 1; i < (row + 1) * length; i++) found[i] += found[i - 1];
  }
  return { step, length, rows, row: (k) => found.subarray(k * length, (k + 1) * length) };
}

export function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// A series as an array of numbers for each frame.
export function series(packed) {
  const { step, length, rows, row } = unpack(packed);
  const values = Array.from({ length }, () => new Float32Array(rows));
  for (let k = 0; k < rows; k++) {
    const steps = row(k);
    for (let i = 0; i < length; i++) values[i][k] = steps[i] * step;
  }
  return values;
}

export class FrameTrack {
  constructor() {
    this.times = [];
    this.frames = [];
  }

  static ofRecording(recording) {
    const track = new FrameTrack();
    const turns = series(recording.turns);
    const places = series(recording.places);
    recording.times.forEach((time, i) => {
      const bodies = places[i].length / 3;
      const poses = new Float32Array(PART * bodies);
      for (let b = 0; b < bodies; b++) {
        poses.set(turns[i].subarray(4 * b, 4 * b + 4), PART * b);
        poses.set(places[i].subarray(3 * b, 3 * b + 3), PART * b + 4);
      }
      track.push(time, poses);
    });
    return track;
  }

  // A live viewer pushes frames as they come; the oldest are let go beyond `keep`.
  push(time, poses, keep = Infinity) {
    this.times.push(time);
    this.frames.push(poses);
    if (this.times.length > keep) {
      this.times.shift();
      this.frames.shift();
    }
  }

  get start() {
    return this.times[0] ?? 0;
  }

  get end() {
    return this.times[this.times.length - 1] ?? 0;
  }

  // The last frame that is not after a time.
  indexAt(time) {
    let low = 0;
    let high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  // Writes the poses at a time to `out`: places between frames, quaternions too (they are near).
  read(time, out) {
    const i = this.indexAt(time);
    const before = this.frames[i];
    const after = this.frames[i + 1];
    if (!after || time <= this.times[i]) {
      out.set(before);
      return i;
    }
    const share = Math.min((time - this.times[i]) / (this.times[i + 1] - this.times[i]), 1);
    for (let k = 0; k < out.length; k += PART) {
      const same = before[k] * after[k] + before[k + 1] * after[k + 1] +
        before[k + 2] * after[k + 2] + before[k + 3] * after[k + 3];
      const sign = same < 0 ? -1 : 1;
      for (let j = k; j < k + 4; j++) out[j] = before[j] + share * (sign * after[j] - before[j]);
      for (let j = k + 4; j < k + PART; j++) out[j] = before[j] + share * (after[j] - before[j]);
    }
    return i;
  }
}
