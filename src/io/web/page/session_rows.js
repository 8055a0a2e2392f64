// SPDX-License-Identifier: MIT
// The columns of a session's frames: docs/session_page.md says what comes. Nothing of it is believed.
import { fields, list, number } from './text.js';

const arrays = { f64: Float64Array, f32: Float32Array, u32: Uint32Array, u16: Uint16Array, u8: Uint8Array };
const mostColumns = 256;

/** The values of one column, of which first all lowest bytes came, then the next. */
function joined(bytes, begin, count, Kind) {
  const size = Kind.BYTES_PER_ELEMENT;
  const values = new Uint8Array(count * size);
  for (let part = 0; part < size; ++part) {
    const from = begin + part * count;
    for (let row = 0, at = part; row < count; ++row, at += size) values[at] = bytes[from + row];
  }
  return new Kind(values.buffer);
}

/** A row a frame, in the order of time. Where only every n-th frame has a row, `every` is n. */
export class Rows {
  /** `facts`: as they came; `bytes`: the columns. Throws a sentence. */
  constructor(facts, bytes) {
    this.every = Math.max(1, Math.round(number(facts.rows_every) ?? 1));
    this.columns = new Map();
    const kinds = list(facts.columns).slice(0, mostColumns).map(fields).map(({ name, type }) => [name, Object.hasOwn(arrays, type) ? arrays[type] : undefined]);
    const rowBytes = kinds.reduce((sum, [, Kind]) => sum + (Kind?.BYTES_PER_ELEMENT ?? NaN), 0);
    this.count = rowBytes > 0 ? bytes.length / rowBytes : NaN;
    if (!Number.isInteger(this.count)) throw new Error('the rows are not as long as their columns say');
    let begin = 0;
    for (const [name, Kind] of kinds) {
      this.columns.set(name, joined(bytes, begin, this.count, Kind));
      begin += this.count * Kind.BYTES_PER_ELEMENT;
    }
    this.time = this.inOrder(this.columns.get('time_s'));
    this.valid = this.get('valid');
    this.period = this.usualStep();
  }

  /** A column, or one that knows nothing. */
  get(name) {
    return this.columns.get(name) ?? new Float32Array(this.count).fill(NaN);
  }

  /** Times that never go back, whatever came. */
  inOrder(times) {
    if (!(times instanceof Float64Array)) throw new Error('the rows have no times');
    let last = 0;
    for (let row = 0; row < times.length; ++row) {
      if (!(times[row] >= last) || times[row] === Infinity) times[row] = last;
      last = times[row];
    }
    return times;
  }

  usualStep() {
    const steps = [];
    const stride = Math.max(1, Math.floor(this.count / 1000));
    for (let row = 1; row < this.count; row += stride) steps.push(this.time[row] - this.time[row - 1]);
    return steps.sort((a, b) => a - b)[steps.length >> 1] || 0.125;
  }

  get begin() {
    return this.count === 0 ? 0 : this.time[0];
  }

  get end() {
    return this.count === 0 ? 1 : Math.max(this.time[this.count - 1], this.time[0] + 1e-3);
  }

  /** The number of the frame in its session. */
  frameOf(row) {
    return row * this.every;
  }

  /** The row of a frame, or the one before it. */
  rowOf(frame) {
    return Math.min(this.count - 1, Math.max(0, Math.floor(frame / this.every)));
  }

  /** The first row at or after a time; `count` behind the last. */
  firstFrom(time) {
    let low = 0;
    let high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[middle] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** The row whose time is nearest. */
  nearest(time) {
    const after = Math.min(this.count - 1, this.firstFrom(time));
    return after > 0 && time - this.time[after - 1] < this.time[after] - time ? after - 1 : after;
  }

  /** The next row, from `row` in steps of `step`, whose validity differs from the one before it. */
  nextChange(row, step) {
    for (let at = row + step; at > 0 && at < this.count; at += step) {
      if (this.valid[at] !== this.valid[at - 1]) return at;
    }
    return step > 0 ? this.count - 1 : 0;
  }
}
