// SPDX-License-Identifier: MIT
// How far the vertical axis of a plot reaches.

/** Least and greatest of the columns where `wanted`, with a margin, never narrower than `least` around zero. */
function extremes(rows, columns, wanted, least) {
  let low = -least;
  let high = least;
  for (const column of columns) {
    column.forEach((value, i) => {
      if (value === null || !wanted(rows[i])) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    });
  }
  const margin = (high - low) * 0.06;
  return [low - margin, high + margin];
}

/** Excluded frames may lie anywhere; they set the scale only where there are no others. */
export function countedFirst(least) {
  return (rows, columns) => {
    const counted = rows.some((row) => row.counted && !row.gap);
    return extremes(rows, columns, (row) => row.counted || !counted, least);
  };
}

export const everything = (least) => (rows, columns) => extremes(rows, columns, () => true, least);
