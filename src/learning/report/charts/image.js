// SPDX-License-Identifier: MIT
// A thermal image with its scale, as the live page colours it.
import { paletteTable } from '../../../io/web/page/palette.js';
import { textStyle } from './theme.js';

const steps = 16;

export function imageOption(chart, theme) {
  const rows = chart.values.length / chart.columns;
  const known = chart.values.filter((value) => value !== null).sort((a, b) => a - b);
  const [low, high] = [0.01, 0.99].map((share) => known[Math.round(share * (known.length - 1))]);  // a bad pixel is no scale
  const table = paletteTable('inferno', false);
  const colours = Array.from({ length: steps }, (_, i) => {
    const at = 3 * Math.round((255 * i) / (steps - 1));
    return `rgb(${table[at]},${table[at + 1]},${table[at + 2]})`;
  });
  const hidden = (count) => ({ type: 'category', show: false, data: Array.from({ length: count }, (_, i) => i) });
  return {
    textStyle: textStyle(theme),
    grid: { left: 20, top: 10, width: 440, height: 330 },
    xAxis: hidden(chart.columns),
    yAxis: { ...hidden(rows), inverse: true },
    visualMap: { type: 'continuous', min: low, max: high, right: 24, top: 'middle', itemHeight: 260,
      precision: 1, text: ['\u00b0C', ''], calculable: true, inRange: { color: colours }, textStyle: textStyle(theme) },
    series: [{ type: 'heatmap', itemStyle: { borderWidth: 0 },
      data: chart.values.map((value, i) => [i % chart.columns, Math.floor(i / chart.columns), value === null ? '-' : Math.min(high, Math.max(low, value))]) }],
  };
}
