// Contacts as runs: stretches of frames in which nothing of a contact changes.
import { columns, floats, integers } from "./unpack.js";

const BLOCK = 32; // frames whose runs are listed together

export class Contacts {
  static async read(packed, sides, frames) {
    const contacts = new Contacts();
    const names = ["key", "start", "length", "mode"];
    await Promise.all(names.map(async (name) => (contacts[name] = await integers(packed[name]))));
    const keys = {};
    await Promise.all(Object.keys(packed.keys).map(async (name) => (keys[name] = await integers(packed.keys[name]))));
    contacts.keys = keys;
    contacts.sides = sides;
    contacts.frames = frames;
    contacts.position = await columns(packed.position);
    contacts.normal = await columns(packed.normal);
    contacts.gap = (await columns(packed.gap))[0];
    contacts.slip = await floats(packed.slip);
    contacts.friction = await floats(packed.friction);
    const force = await floats(packed.force), count = contacts.key.length;
    contacts.force = [0, 1, 2].map((axis) => force.subarray(axis * count, (axis + 1) * count));
    contacts.derive();
    contacts.index();
    return contacts;
  }

  get count() {
    return this.key.length;
  }

  // Normal part, size and tangential part of each force [N].
  derive() {
    const [x, y, z] = this.force, [nx, ny, nz] = this.normal;
    for (const name of ["normalForce", "size", "tangentialForce"]) this[name] = new Float32Array(this.count);
    for (let i = 0; i < this.count; ++i) {
      const along = x[i] * nx[i] + y[i] * ny[i] + z[i] * nz[i];
      this.normalForce[i] = along;
      this.size[i] = Math.hypot(x[i], y[i], z[i]);
      this.tangentialForce[i] = Math.hypot(x[i] - along * nx[i], y[i] - along * ny[i], z[i] - along * nz[i]);
    }
  }

  // Lists the runs of each block of frames, and the largest number of contacts of a frame.
  index() {
    const blocks = Math.floor(Math.max(this.frames - 1, 0) / BLOCK) + 1;
    const eachBlock = (run, visit) => {
      for (let b = Math.floor(this.start[run] / BLOCK); b * BLOCK < this.start[run] + this.length[run]; ++b) visit(b);
    };
    this.blockBegin = new Int32Array(blocks + 1);
    const change = new Int32Array(this.frames + 1);
    for (let run = 0; run < this.count; ++run) {
      eachBlock(run, (b) => ++this.blockBegin[b + 1]);
      ++change[this.start[run]];
      --change[this.start[run] + this.length[run]];
    }
    for (let b = 0; b < blocks; ++b) this.blockBegin[b + 1] += this.blockBegin[b];
    this.blockRuns = new Int32Array(this.blockBegin[blocks]);
    const next = this.blockBegin.slice();
    for (let run = 0; run < this.count; ++run) eachBlock(run, (b) => (this.blockRuns[next[b]++] = run));
    this.most = 0;
    for (let frame = 0, now = 0; frame < this.frames; ++frame) this.most = Math.max(this.most, (now += change[frame]));
  }

  // Calls visit(run) for the contacts of a frame.
  at(frame, visit) {
    const block = Math.floor(frame / BLOCK);
    for (let i = this.blockBegin[block]; i < this.blockBegin[block + 1]; ++i) {
      const run = this.blockRuns[i];
      if (this.start[run] <= frame && frame < this.start[run] + this.length[run]) visit(run);
    }
  }

  use(run) {
    const limit = this.friction[run] * this.normalForce[run];
    return limit > 0 ? this.tangentialForce[run] / limit : NaN;
  }

  sideName(side) {
    const [body, link] = this.sides[side];
    return body === link || !link ? body : `${body}/${link}`;
  }

  sideA(run) {
    return this.keys.side_a[this.key[run]];
  }

  sideB(run) {
    return this.keys.side_b[this.key[run]];
  }

  // id as in messages and CSV files: more than a number holds.
  id(run) {
    const key = this.key[run], { id_high: high, id_middle: middle, id_low: low } = this.keys;
    return ((BigInt(high[key]) << 40n) | (BigInt(middle[key]) << 16n) | BigInt(low[key])).toString();
  }
}
