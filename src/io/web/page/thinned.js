// SPDX-License-Identifier: MIT
// Rows for a plot: no more of them than there are pixels to draw them in.

const known = (value) => (Number.isFinite(value) ? value : null);

/** Least and greatest of a column's values in [from, to), in their order; of one that knows nothing, nulls. */
function extremesOf(column, from, to) {
  let least = -1;
  let greatest = -1;
  for (let row = from; row < to; ++row) {
    const value = column[row];
    if (!Number.isFinite(value)) continue;
    if (least < 0 || value < column[least]) least = row;
    if (greatest < 0 || value > column[greatest]) greatest = row;
  }
  if (least < 0) return [null, null];
  return least < greatest ? [column[least], column[greatest]] : [column[greatest], column[least]];
}

/** Most of a bucket's frames say whether it is hatched. */
function isMostlyValid(valid, from, to) {
  let count = 0;
  for (let row = from; row < to; ++row) count += valid[row];
  return 2 * count >= to - from;
}

const gapAt = (time, columns) => ({ time, gap: true, counted: true, values: columns.map(() => null) });

/** Each frame a row, and a gap where frames are missing. */
function eachRow(rows, columns, from, to) {
  const shown = [];
  for (let row = from; row < to; ++row) {
    const time = rows.time[row];
    if (row > from && time - rows.time[row - 1] > 1.8 * rows.period) shown.push(gapAt((time + rows.time[row - 1]) / 2, columns));
    shown.push({ time, counted: rows.valid[row] === 1, values: columns.map((column) => known(column[row])) });
  }
  return shown;
}

/** Each bucket of neighbours two rows: what lies between them is drawn as a line from the least to the greatest. */
function bucketRows(rows, columns, from, to, buckets) {
  const shown = [];
  for (let bucket = 0; bucket < buckets; ++bucket) {
    const first = from + Math.floor(((to - from) * bucket) / buckets);
    const end = from + Math.floor(((to - from) * (bucket + 1)) / buckets);
    const pairs = columns.map((column) => extremesOf(column, first, end));
    const counted = isMostlyValid(rows.valid, first, end);
    for (const side of [0, 1]) {
      shown.push({ time: side === 0 ? rows.time[first] : rows.time[end - 1], counted, values: pairs.map((pair) => pair[side]) });
    }
  }
  return shown;
}

/** What a plot of so many pixels shows of `columns` between two times, and of the rows next to them. */
export function thinned(rows, columns, [begin, end], pixels) {
  const from = Math.max(0, rows.firstFrom(begin) - 1);
  const to = Math.min(rows.count, rows.firstFrom(end) + 2);
  const buckets = Math.max(1, Math.floor(pixels));
  return to - from <= 2 * buckets ? eachRow(rows, columns, from, to) : bucketRows(rows, columns, from, to, buckets);
}

/** The share of valid frames in each of so many equal parts of the session, of the nearest frame where a part has none; null in gaps. */
export function validShares(rows, parts) {
  const step = (rows.end - rows.begin) / parts;
  return Array.from({ length: parts }, (unused, part) => {
    const begin = rows.begin + step * part;
    const from = rows.firstFrom(begin);
    const to = part === parts - 1 ? rows.count : rows.firstFrom(begin + step);
    if (to <= from) {
      const near = rows.nearest(begin + step / 2);
      return Math.abs(rows.time[near] - begin - step / 2) > rows.period ? null : rows.valid[near];
    }
    let count = 0;
    for (let row = from; row < to; ++row) count += rows.valid[row];
    return count / (to - from);
  });
}
