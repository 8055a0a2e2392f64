// SPDX-License-Identifier: MIT
import { estimateOf, noEstimate } from './estimators.js';
import { list, number, plain } from './text.js';

export const shownSeconds = 60;
// A minute at 64 frames/s, the fastest that a camera of the rig can do.
const mostFrames = 64 * (shownSeconds + 2);

/** One frame's message as numbers and nulls, with an estimate for each of `estimators`. */
function rowOf(message, estimators) {
  return {
    index: number(message.index),
    time: number(message.time_s),
    begin: number(message.begin_s),
    end: number(message.end_s),
    counted: message.counted === true,
    reasons: list(message.reasons).slice(0, 16).map((reason) => plain(reason, 60)).filter((reason) => reason !== ''),
    excluded: plain(message.excluded, 200),
    commanded: number(message.commanded_dps),
    estimates: estimators.map((estimator) => estimateOf(message, estimator)),
  };
}

/** The frames of the last minute in their order; where frames are missing, a row without values. */
export class History {
  constructor() {
    this.clear([]);
  }

  /** `estimators`: those of the run that begins. */
  clear(estimators) {
    this.estimators = estimators;
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
    const row = rowOf(message, this.estimators);
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
    return { index: before.index, time: (before.time + after.time) / 2, gap: true, counted: true, reasons: [], commanded: null,
      estimates: this.estimators.map(() => noEstimate) };
  }
}
