// SPDX-License-Identifier: MIT
import { axis, legend, number, textStyle, tooltip } from './theme.js';

/** What may cover what, from below. */
const order = ['gyro', 'gyro-rest', 'gyro-kalman', 'thermal-likelihood', 'cnn-thermal', 'odometer', 'cnn-fusion', 'cnn-fusion-kalman'];

/** Lines over a common axis: angle errors, errors by speed, training curves. */
export function linesOption(chart, theme) {
  const names = chart.lines.map((line) => line.name);
  const logarithmic = chart.log === true && chart.lines.every((line) => line.y.every((y) => y === null || y > 0));
  return {
    textStyle: textStyle(theme),
    grid: { left: 66, right: 18, top: 14, bottom: 46 },
    legend: legend(names),
    tooltip: tooltip(theme, { trigger: 'axis', valueFormatter: number }),
    xAxis: axis(theme, chart.x, { type: 'value', min: chart.thinned === true ? 0 : 'dataMin', max: 'dataMax', nameGap: 26,
      minInterval: chart.points === true ? 1 : 0,
      splitLine: { show: false } }),
    yAxis: axis(theme, logarithmic ? `${chart.y} (logarithmic)` : chart.y, {
      type: logarithmic ? 'log' : 'value', nameGap: 50,
    }),
    series: chart.lines.map((line) => ({
      type: 'line', name: line.name, z: order.indexOf(line.key) + 2, data: line.x.map((x, i) => [x, line.y[i]]), showSymbol: chart.points === true,
      sampling: chart.thinned === true ? 'lttb' : undefined, symbolSize: 4, lineStyle: { color: theme.colourOf(line.key), ...theme.strokeOf(line.key) },
      itemStyle: { color: theme.colourOf(line.key) },
    })),
  };
}

/** Shares of windows by Kg. */
export function histogramOption(chart, theme) {
  const all = chart.counts.reduce((sum, count) => sum + count, 0);
  const width = 1 / chart.counts.length;
  const colour = theme.colourOf('cnn-fusion');
  return {
    textStyle: textStyle(theme),
    grid: { left: 66, right: 18, top: 14, bottom: 50 },
    tooltip: tooltip(theme, {
      trigger: 'item',
      formatter: ({ value }) => `Kg ${number(value[0])} to ${number(value[1])}\n${number(value[2])} % of windows`,
    }),
    xAxis: axis(theme, chart.axis, { type: 'value', min: 0, max: 1, nameGap: 28, splitLine: { show: false } }),
    yAxis: axis(theme, 'share of windows, %', { type: 'value', nameGap: 46 }),
    series: [{
      type: 'custom',
      data: chart.counts.map((count, i) => [i * width, (i + 1) * width, all > 0 ? (100 * count) / all : 0]),
      encode: { x: [0, 1], y: 2 },
      renderItem: (params, api) => {
        const corner = api.coord([api.value(0), api.value(2)]), foot = api.coord([api.value(1), 0]);
        return {
          type: 'rect',
          shape: { x: corner[0] + 1, y: corner[1], width: foot[0] - corner[0] - 2, height: foot[1] - corner[1] },
          style: { fill: colour },
        };
      },
      markLine: chart.mean === null ? undefined : {
        silent: true, symbol: 'none', lineStyle: { color: theme.ink, type: 'dashed' },
        label: { show: false }, data: [{ xAxis: chart.mean }],
      },
    }],
  };
}

/** Bars side by side, their values written on them. */
export function barsOption(chart, theme) {
  return {
    textStyle: textStyle(theme),
    grid: { left: 66, right: 14, top: 24, bottom: 46 },
    legend: legend(chart.bars.map((bar) => bar.name)),
    tooltip: tooltip(theme, { trigger: 'axis', valueFormatter: number }),
    xAxis: axis(theme, chart.x, { type: 'category', data: chart.categories, nameGap: 26,
      axisLabel: { color: theme.quiet } }),
    yAxis: axis(theme, chart.y, { type: 'value', nameGap: 50 }),
    series: chart.bars.map((bar) => ({
      type: 'bar', name: bar.name, data: bar.values, barMaxWidth: 60, itemStyle: { color: theme.colourOf(bar.key) },
      label: { show: true, position: 'top', color: theme.ink, formatter: (item) => number(item.value) },
    })),
  };
}
