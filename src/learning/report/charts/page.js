// SPDX-License-Identifier: MIT
// Draws the charts of a report. Their data are in the page, see ../document.h; no text of them becomes markup.
import * as echarts from 'echarts/core';
import { BarChart, CustomChart, LineChart, ScatterChart } from 'echarts/charts';
import { GridComponent, LegendComponent, MarkLineComponent, TooltipComponent } from 'echarts/components';
import { SVGRenderer } from 'echarts/renderers';
import { themeNow } from './theme.js';
import { optionOf } from './options.js';
import { addLegend } from './legend.js';

echarts.use([BarChart, CustomChart, LineChart, ScatterChart, GridComponent, LegendComponent, MarkLineComponent,
  TooltipComponent, SVGRenderer]);

const data = JSON.parse(document.getElementById('charts').textContent);
const places = [...document.querySelectorAll('.chart')];
let drawn = [];

function draw() {
  for (const chart of drawn) chart.dispose();
  const theme = themeNow();
  drawn = places.map((place) => {
    const chart = echarts.init(place, null, { renderer: 'svg' });
    const described = data[Number(place.dataset.chart)];
    chart.setOption({ animation: false, ...optionOf(described, theme) });
    if (place.closest('.small') === null) addLegend(place, [[chart, described]], theme);
    return chart;
  });
  document.querySelectorAll('.small').forEach((group) => {
    const inside = drawn.filter((chart) => group.contains(chart.getDom()));
    addLegend(group, inside.map((chart) => [chart, data[Number(chart.getDom().dataset.chart)]]), theme);
  });
}

function resize() {
  for (const chart of drawn) chart.resize();
}

draw();
new ResizeObserver(resize).observe(document.querySelector('main'));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);

// On paper: light, as wide as the paper, nothing folded away.
const unfolded = [];
addEventListener('beforeprint', () => {
  document.querySelectorAll('main details:not([open])').forEach((part) => {
    part.open = true;
    unfolded.push(part);
  });
});
addEventListener('afterprint', () => {
  for (const part of unfolded.splice(0)) part.open = false;
});
matchMedia('print').addEventListener('change', draw);
