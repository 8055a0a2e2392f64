// SPDX-License-Identifier: MIT
// Which temperatures the ends of the colour map stand for.

const leastSpan = 1.0;      // degC, so that noise alone does not look like a scene
const releaseSeconds = 4.0;  // a range that has become too wide shrinks with this time constant

/** Linear between the two nearest of `sorted`. */
function quantile(sorted, share) {
  const place = share * (sorted.length - 1);
  const low = Math.floor(place);
  return sorted[low] + (sorted[Math.min(low + 1, sorted.length - 1)] - sorted[low]) * (place - low);
}

/** 2nd to 98th percentile: widens at once, shrinks slowly, stands still while locked. */
export class AutoRange {
  constructor() {
    this.locked = false;
    this.clear();
  }

  clear() {
    this.low = null;
    this.high = null;
    this.time = null;
  }

  /** `temperatures`: all finite, at least one. */
  follow(temperatures, time) {
    if (this.locked && this.low !== null) return;
    const sorted = Float32Array.from(temperatures).sort();
    let low = quantile(sorted, 0.02);
    let high = quantile(sorted, 0.98);
    const missing = leastSpan - (high - low);
    if (missing > 0) {
      low -= missing / 2;
      high += missing / 2;
    }
    const seconds = this.time === null || time === null ? 0 : Math.max(0, time - this.time);
    const keep = Math.exp(-seconds / releaseSeconds);
    this.low = this.low === null ? low : Math.min(low, low + (this.low - low) * keep);
    this.high = this.high === null ? high : Math.max(high, high + (this.high - high) * keep);
    this.time = time;
  }
}
