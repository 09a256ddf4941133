// Poses over time by keyframes: straight in between, as keyframes() of src/tools/recording/pack.py promises.
import { columns, integers } from "./unpack.js";

// The last index in [first, end) whose value is at most `value`.
export function lastNotAfter(values, value, first = 0, end = values.length) {
  while (end - first > 1) {
    const middle = (first + end) >> 1;
    if (values[middle] <= value) first = middle;
    else end = middle;
  }
  return first;
}

export class Tracks {
  static async read(packed) {
    const tracks = new Tracks();
    const advance = await integers(packed.advance);
    tracks.position = await columns(packed.position);
    tracks.rotation = await columns(packed.rotation);
    tracks.shown = packed.shown;
    tracks.first = [0];
    tracks.keys = new Int32Array(advance.length);
    for (const count of packed.counts) {
      const begin = tracks.first[tracks.first.length - 1];
      for (let i = 0, frame = 0; i < count; ++i) tracks.keys[begin + i] = frame += advance[begin + i];
      tracks.first.push(begin + count);
    }
    return tracks;
  }

  get count() {
    return this.shown.length;
  }

  isShown(track, frame) {
    return this.shown[track].some(([first, last]) => first <= frame && frame <= last);
  }

  // Writes the pose at a frame, which may lie between two; false where the thing is not there.
  pose(track, frame, position, quaternion) {
    const begin = this.first[track], end = this.first[track + 1];
    if (begin === end || !this.isShown(track, Math.floor(frame))) return false;
    const a = lastNotAfter(this.keys, frame, begin, end), b = Math.min(a + 1, end - 1);
    const share = b > a ? (frame - this.keys[a]) / (this.keys[b] - this.keys[a]) : 0;
    const between = (column) => column[a] + share * (column[b] - column[a]);
    const [x, y, z] = this.position, [qx, qy, qz, qw] = this.rotation; // no arrays are made: this runs for all links, sixty times a second
    position.set(between(x), between(y), between(z));
    quaternion.set(between(qx), between(qy), between(qz), between(qw)).normalize();
    return true;
  }
}
