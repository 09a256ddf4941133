// What the plots show, by frame, from the contacts' runs.

// Sum over contacts in each frame; `value(run)` is the same during a run.
function sums(contacts, value, chosen = () => true) {
  const change = new Float64Array(contacts.frames + 1);
  const count = new Int32Array(contacts.frames + 1);
  for (let run = 0; run < contacts.count; ++run) {
    if (!chosen(run)) continue;
    const begin = contacts.start[run], end = begin + contacts.length[run], amount = value(run);
    change[begin] += amount;
    change[end] -= amount;
    ++count[begin];
    --count[end];
  }
  const result = new Float64Array(contacts.frames);
  for (let frame = 0, sum = 0, number = 0; frame < contacts.frames; ++frame) {
    sum += change[frame];
    number += count[frame];
    if (number === 0) sum = 0; // no remainder of large sums
    result[frame] = sum;
  }
  return result;
}

// Sum of the normal forces on a side [N].
export function normalForce(contacts, side) {
  const mine = (run) => contacts.sideA(run) === side || contacts.sideB(run) === side;
  return sums(contacts, (run) => contacts.normalForce[run], mine);
}

// Sides with the largest mean normal force, the ground's not among them.
export function largestSides(contacts, number) {
  const mean = new Map();
  for (let run = 0; run < contacts.count; ++run)
    for (const side of [contacts.sideA(run), contacts.sideB(run)])
      if (contacts.sides[side][0] !== "ground")
        mean.set(side, (mean.get(side) ?? 0) + contacts.normalForce[run] * contacts.length[run]);
  return [...mean.entries()].sort((a, b) => b[1] - a[1]).slice(0, number).map(([side]) => side);
}

export function sidesInContact(contacts) {
  const found = new Set();
  for (let key = 0; key < contacts.keys.side_a.length; ++key) found.add(contacts.keys.side_a[key]).add(contacts.keys.side_b[key]);
  return [...found].filter((side) => contacts.sides[side][0] !== "ground");
}

export function modeCount(contacts, mode) {
  return sums(contacts, () => 1, (run) => contacts.mode[run] === mode);
}

// Largest |r_T| / (mu r_N) of a frame over contacts that carry a thousandth of the median force at least: of less the rounded numbers
// say little. null where there is none.
export function frictionUse(contacts) {
  const result = new Array(contacts.frames).fill(null);
  const least = 1e-3 * typicalForce(contacts);
  for (let run = 0; run < contacts.count; ++run) {
    const use = contacts.use(run);
    if (!(contacts.normalForce[run] > least) || !Number.isFinite(use)) continue;
    for (let frame = contacts.start[run], end = frame + contacts.length[run]; frame < end; ++frame)
      if (result[frame] === null || use > result[frame]) result[frame] = use;
  }
  return result;
}

// Median size of the forces that are not zero [N]; 1 without any.
export function typicalForce(contacts) {
  const sizes = contacts.size.filter((size) => size > 0).sort();
  return sizes.length ? sizes[sizes.length >> 1] : 1;
}
