// SPDX-License-Identifier: MIT
// A chart as SVG for print, drawn without a browser: light, still, with its legend in it.
import './engine.js';
import * as echarts from 'echarts/core';
import { BarChart, CustomChart, HeatmapChart, LineChart, ScatterChart } from 'echarts/charts';
import { GraphicComponent, GridComponent, LegendComponent, MarkLineComponent,
  VisualMapContinuousComponent } from 'echarts/components';
import { SVGRenderer } from 'echarts/renderers';
import { paletteTable } from '../../../io/web/page/palette.js';
import { optionOf } from './options.js';
import { textStyle, themeOf } from './theme.js';

echarts.use([BarChart, CustomChart, HeatmapChart, LineChart, ScatterChart, GraphicComponent, GridComponent, LegendComponent,
  MarkLineComponent, VisualMapContinuousComponent, SVGRenderer]);

const width = 600, height = 360;  // CSS pixels: 159 mm wide, a page's text; letters are of 9 pt
const row = 32, letter = 6.6, sample = 68;

// PRINT_COLOURS: those that the style sheets name first, see build.mjs
const theme = themeOf((name) => PRINT_COLOURS[name], 'Liberation Sans, Arial, Helvetica, sans-serif');

/** As ECharts lays them out, side by side while there is room. */
function legendRows(names) {
  let rows = 1, used = 0;
  for (const name of names) {
    const wide = sample + letter * name.length;
    if (used > 0 && used + wide > width - 20) {
      rows += 1;
      used = 0;
    }
    used += wide;
  }
  return rows;
}

function withLegend(option) {
  const names = option.legend === undefined ? [] : option.legend.data;
  if (names.length === 0) return option;
  option.legend = { ...option.legend, show: true, top: 0, left: 'center', width: width - 20, itemWidth: 34, itemHeight: 9,
    itemGap: 26, textStyle: { color: theme.ink, fontSize: 11 } };
  const bare = option.series.filter((series) => series.showSymbol === false || series.symbol === 'none').map((series) => series.name);
  option.legend.data = names.map((name) => (bare.indexOf(name) >= 0 ? { name, itemStyle: { opacity: 0 } } : name));  // else a circle on each line
  option.grid.top = row * legendRows(names);
  return option;
}

/** A thermal image with its scale, as the live page colours it. */
function imageOption(chart) {
  const rows = chart.values.length / chart.columns;
  const known = chart.values.filter((value) => value !== null).sort((a, b) => a - b);
  const [low, high] = [0.01, 0.99].map((share) => known[Math.round(share * (known.length - 1))]);  // a bad pixel is no scale
  const steps = 16;
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

/** No character beyond ASCII, whatever encoding the engine hands strings over in. */
function ascii(text) {
  return text.replace(/[\ud800-\udbff][\udc00-\udfff]/g, (pair) =>
    `&#${(pair.charCodeAt(0) - 0xd800) * 0x400 + pair.charCodeAt(1) - 0xdc00 + 0x10000};`)
    .replace(/[\ud800-\udfff]/g, '?').replace(/[\u0080-\uffff]/g, (one) => `&#${one.charCodeAt(0)};`);
}

/** Without what a page would do under a pointer, and with letters where rsvg-convert sets them, too: it knows no dominant-baseline. */
function still(svg) {
  return svg.replace(/dominant-baseline="central"/g, 'dy="0.35em"').replace(/<style[\s\S]*?<\/style>\n?/g, '').replace(/ (?:ecmeta_[a-z_]+|class|pointer-events)="[^"<>]*"/g, '');
}

/** `chart`: as ../document.h describes it; `remark`: what has to be seen beside it, or nothing. */
global.figure = (chart, remark) => {
  const drawn = echarts.init(null, null, { renderer: 'svg', ssr: true, width, height });
  const option = chart.kind === 'image' ? imageOption(chart) : withLegend(optionOf(chart, theme));
  if (remark !== '') option.graphic = [{ type: 'text', right: 4, bottom: 2, style: { text: remark, fill: theme.quiet, fontSize: 10 } }];
  drawn.setOption({ animation: false, backgroundColor: theme.paper, ...option });
  const svg = still(drawn.renderToSVGString());
  drawn.dispose();
  return ascii(chart.kind === 'image' ? svg.replace('<svg ', '<svg shape-rendering="crispEdges" ') : svg);  // no seams
};
