// SPDX-License-Identifier: MIT
// The options of ECharts for a chart, by its kind.
import { boxesOption } from './boxes.js';
import { barsOption, histogramOption, linesOption } from './simple.js';

const kinds = { boxes: boxesOption, histogram: histogramOption, lines: linesOption, bars: barsOption };

export function optionOf(chart, theme) {
  return kinds[chart.kind](chart, theme);
}
