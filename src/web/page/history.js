// SPDX-License-Identifier: MIT
import { fields, list, number, plain } from './text.js';

export const shownSeconds = 60;
// A minute at 64 frames/s, the fastest that a camera of the rig can do.
const mostFrames = 64 * (shownSeconds + 2);

const minus = (a, b) => (a === null || b === null ? null : a - b);

/** One frame's message as numbers and nulls. */
function rowOf(message) {
  const scores = fields(message.scores);
  const commanded = number(message.commanded_dps);
  const row = {
    index: number(message.index),
    time: number(message.time_s),
    begin: number(message.begin_s),
    end: number(message.end_s),
    counted: message.counted === true,
    valid: message.valid === true,
    reasons: list(message.reasons).slice(0, 16).map((reason) => plain(reason, 60)).filter((reason) => reason !== ''),
    apart: plain(message.apart, 200),
    commanded,
    gain: number(message.gain),
    values: {},
    errors: {},
    angles: {},
  };
  for (const key of ['thermal', 'gyro', 'fusion']) {
    row.values[key] = number(message[`${key}_dps`]);
    row.errors[key] = minus(row.values[key], commanded);
    row.angles[key] = number(fields(scores[key]).angle_error_deg);
  }
  return row;
}

/** The frames of the last minute in their order; where frames are missing, a row without values. */
export class History {
  constructor() {
    this.clear();
  }

  clear() {
    this.rows = [];
    this.steps = [];  // seconds between the last frames
    this.period = 0.125;
  }

  /** The rate that the camera should have. */
  expect(framesPerSecond) {
    const rate = number(framesPerSecond);
    if (rate !== null && rate > 0) this.period = 1 / rate;
  }

  /** Longer steps in time are gaps: at most one frame of those that come, or should come, fits in. */
  get longestStep() {
    const median = [...this.steps].sort((a, b) => a - b)[this.steps.length >> 1] ?? 0;
    return 1.8 * Math.max(this.period, median);
  }

  get last() {
    return this.rows.at(-1) ?? null;
  }

  /** False for what is no frame or is known already (a page that comes back gets the last 512 frames again). */
  add(message) {
    const row = rowOf(message);
    if (row.time === null || row.index === null) return false;
    const last = this.last;
    if (last !== null && (row.index <= last.index || row.time <= last.time)) return false;
    const missing = last !== null && (row.index > last.index + 1 || row.time - last.time > this.longestStep);
    if (last !== null) this.steps = [...this.steps.slice(-14), row.time - last.time];
    if (missing) this.rows.push(this.gap(last, row));
    this.rows.push(row);
    let old = Math.max(0, this.rows.length - mostFrames);
    while (this.rows[old].time < row.time - shownSeconds - 2) ++old;
    if (old > 0) this.rows.splice(0, old);
    return true;
  }

  gap(before, after) {
    const nothing = { thermal: null, gyro: null, fusion: null };
    return { index: before.index, time: (before.time + after.time) / 2, gap: true, counted: true, reasons: [], commanded: null,
      gain: null, values: nothing, errors: nothing, angles: nothing };
  }
}
