// SPDX-License-Identifier: MIT
// Box plots over folds, the single folds as points: a box is the quartiles and the median, its whiskers reach the
// smallest and the largest fold.
import { axis, legend, number, textStyle, tooltip } from './theme.js';

const boxWidth = 0.26, gap = 0.17;

/** Linear interpolation between order statistics, as the tables. */
function quantile(sorted, share) {
  const at = (sorted.length - 1) * share, below = Math.floor(at);
  const above = Math.min(below + 1, sorted.length - 1);
  return sorted[below] + (sorted[above] - sorted[below]) * (at - below);
}

function five(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return [0, 0.25, 0.5, 0.75, 1].map((share) => quantile(sorted, share));
}

function known(points) {
  return points.filter((point) => point.mse !== null);
}

function boxItem(colour, paper) {
  return (params, api) => {
    const x = api.value(0), half = boxWidth / 2;
    const at = (value, offset) => api.coord([x + offset, value]);
    const [low, first, median, third, high] = [1, 2, 3, 4, 5].map((i) => api.value(i));
    const stroke = { stroke: colour, lineWidth: 1.6, fill: 'none' };
    const line = (from, to, width) => ({
      type: 'line',
      shape: { x1: from[0], y1: from[1], x2: to[0], y2: to[1] },
      style: { ...stroke, lineWidth: width ?? 1.6 },
    });
    const corner = at(third, -half), opposite = at(first, half);
    return {
      type: 'group',
      children: [
        line(at(low, 0), at(first, 0)),
        line(at(third, 0), at(high, 0)),
        line(at(low, -half / 2), at(low, half / 2)),
        line(at(high, -half / 2), at(high, half / 2)),
        {
          type: 'rect',
          shape: { x: corner[0], y: corner[1], width: opposite[0] - corner[0], height: opposite[1] - corner[1] },
          style: { ...stroke, fill: colour, fillOpacity: 0.16 },
        },
        line(at(median, -half), at(median, half), 3),
      ],
    };
  };
}

function place(index, side) {
  return index + (side === 0 ? -gap : gap);
}

function boxSeries(box, side, theme) {
  const colour = theme.colourOf(box.key);
  const data = box.points.flatMap((points, i) => {
    const values = known(points).map((point) => point.mse);
    return values.length ? [[place(i, side), ...five(values)]] : [];
  });
  return {
    type: 'custom', name: box.name, renderItem: boxItem(colour), data, itemStyle: { color: colour },
    dimensions: ['x', 'low', 'first', 'median', 'third', 'high'], encode: { x: 0, y: [1, 2, 3, 4, 5] }, z: 2,
    tooltip: {
      formatter: ({ value }) => `${box.name}\nmedian ${number(value[3])}\nquartiles ${number(value[2])} to `
        + `${number(value[4])}\nfolds ${number(value[1])} to ${number(value[5])}`,
    },
  };
}

function pointSeries(box, side, theme, scale) {
  const colour = theme.colourOf(box.key);
  const data = box.points.flatMap((points, i) => known(points).map((point, k) => ({
    value: [place(i, side) + 0.03 * ((k % 3) - 1), point.mse], fold: point.fold,
  })));
  return {
    type: 'scatter', name: box.name, data, symbolSize: 6, z: 4,
    itemStyle: { color: colour, borderColor: theme.paper, borderWidth: 1 },
    tooltip: {
      formatter: (item) => `${item.data.fold}\n${box.name}: ${number(item.value[1])}\n`
        + `RMSE ${number(Math.sqrt(item.value[1]) * scale)} deg/s`,
    },
  };
}

function lineSeries(line, theme) {
  return {
    type: 'line', name: line.name, symbol: 'none', z: 3, connectNulls: false,
    data: line.values.flatMap((value, i) => [[i - 0.45, value], [i + 0.45, value], [i + 0.45, null]]),
    lineStyle: { color: theme.colourOf(line.key), ...theme.strokeOf(line.key), width: 2 },
    itemStyle: { color: theme.colourOf(line.key) },
    tooltip: { formatter: (item) => `${line.name}: ${number(item.value[1])}` },
  };
}

function paperSeries(line, side, theme) {
  return {
    type: 'scatter', name: line.name, symbol: 'diamond', symbolSize: 13, z: 5,
    data: line.values.flatMap((value, i) => (value === null ? [] : [[place(i, side), value]])),
    itemStyle: { color: theme.paper, borderColor: theme.colourOf(line.key), borderWidth: 2 },
    tooltip: { formatter: (item) => `${line.name}: ${number(item.value[1])}` },
  };
}

export function boxesOption(chart, theme) {
  const values = chart.boxes.flatMap((box) => box.points.flatMap((points) => known(points).map((p) => p.mse)))
    .concat([...chart.lines, ...chart.paper].flatMap((line) => line.values.filter((value) => value !== null)));
  const logarithmic = values.length > 0 && Math.min(...values) > 0;
  const names = [...chart.boxes, ...chart.lines, ...chart.paper].map((series) => series.name);
  return {
    textStyle: textStyle(theme),
    grid: { left: 66, right: 14, top: 14, bottom: 48 },
    legend: legend(names),
    tooltip: tooltip(theme, { trigger: 'item' }),
    xAxis: axis(theme, chart.axis, {
      type: 'value', min: -0.5, max: chart.categories.length - 0.5, interval: 0.5, nameGap: 28,
      splitLine: { show: false },
      axisTick: { show: false },
      axisLabel: { color: theme.quiet, formatter: (value) => chart.categories[value] ?? '' },
    }),
    yAxis: axis(theme, logarithmic ? `${chart.unit} (logarithmic)` : chart.unit, {
      type: logarithmic ? 'log' : 'value', nameGap: 50,
    }),
    series: [
      ...chart.lines.map((line) => lineSeries(line, theme)),
      ...chart.boxes.map((box, side) => boxSeries(box, side, theme)),
      ...chart.boxes.map((box, side) => pointSeries(box, side, theme, chart.scale)),
      ...chart.paper.map((line, side) => paperSeries(line, side, theme)),
    ],
  };
}
