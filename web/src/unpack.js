// Reads the columns that src/tools/recording/pack.py writes: deflated bytes by significance, zigzag differences of rounded numbers.

// Bytes of deflated base64.
export async function inflate(text) {
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Planes of bytes back to whole numbers of so many bytes.
function joinPlanes(planes, size) {
  const count = planes.length / size;
  const bytes = new Uint8Array(planes.length);
  for (let plane = 0; plane < size; ++plane)
    for (let i = 0, from = plane * count; i < count; ++i) bytes[i * size + plane] = planes[from + i];
  return bytes.buffer;
}

// Float32Array or Float64Array of kind f4, f8.
export async function floats(packed) {
  const planes = await inflate(packed.data);
  return packed.kind === "f8" ? new Float64Array(joinPlanes(planes, 8)) : new Float32Array(joinPlanes(planes, 4));
}

// Columns of kind int, each a Float64Array: sums of the differences, in multiples of the resolution.
export async function columns(packed) {
  const zigzag = new Uint32Array(joinPlanes(await inflate(packed.data), 4));
  const rows = zigzag.length / packed.columns;
  const result = [];
  for (let column = 0; column < packed.columns; ++column) {
    const values = new Float64Array(rows);
    let sum = 0;
    for (let row = 0; row < rows; ++row) {
      const code = zigzag[column * rows + row];
      sum += code % 2 ? -(code - 1) / 2 - 1 : code / 2;
      values[row] = sum * packed.resolution;
    }
    result.push(values);
  }
  return result;
}

export async function integers(packed) {
  return Int32Array.from((await columns(packed))[0]);
}
