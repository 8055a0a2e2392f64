// SPDX-License-Identifier: MIT
// Legends as part of the page: they wrap, print, and are buttons that hide and show what they name.

const svg = 'http://www.w3.org/2000/svg';

function element(name, attributes) {
  const made = document.createElementNS(svg, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  return made;
}

function line(colour, stroke) {
  const dashes = Array.isArray(stroke.type) ? { 'stroke-dasharray': stroke.type.join(' ') } : {};
  return element('line', { x1: 0, y1: 6, x2: 34, y2: 6, stroke: colour, 'stroke-width': stroke.width, ...dashes });
}

function box(colour) {
  return element('rect', { x: 8, y: 1, width: 18, height: 10, stroke: colour, fill: colour, 'fill-opacity': 0.5 });
}

function diamond(colour) {
  return element('path', { d: 'M17 0L23 6L17 12L11 6Z', stroke: colour, 'stroke-width': 1.6, fill: 'none' });
}

/** What a chart shows, each with the picture that stands for it. */
function entriesOf(chart, theme) {
  const entries = [];
  for (const part of [...(chart.boxes ?? []), ...(chart.bars ?? [])])
    entries.push([part.name, box(theme.colourOf(part.key))]);
  for (const part of chart.lines ?? [])
    entries.push([part.name, line(theme.colourOf(part.key), theme.strokeOf(part.key))]);
  for (const part of chart.paper ?? []) entries.push([part.name, diamond(theme.colourOf(part.key))]);
  return entries;
}

function button(name, picture, toggle) {
  const made = document.createElement('button');
  const frame = element('svg', { width: 34, height: 12, 'aria-hidden': 'true' });
  made.type = 'button';
  made.setAttribute('aria-pressed', 'true');
  made.title = 'Hide or show';
  frame.append(picture);
  made.append(frame, name);
  made.addEventListener('click', () => {
    made.setAttribute('aria-pressed', String(made.getAttribute('aria-pressed') !== 'true'));
    toggle(name);
  });
  return made;
}

/** One legend before `place`, for all `charts`: pairs of a drawn chart and its description. */
export function addLegend(place, charts, theme) {
  if (place.previousElementSibling?.className === 'legend') place.previousElementSibling.remove();
  const entries = new Map(charts.flatMap(([, described]) => entriesOf(described, theme)));
  if (entries.size === 0) return;
  const toggle = (name) => {
    for (const [chart] of charts) chart.dispatchAction({ type: 'legendToggleSelect', name });
  };
  const legend = document.createElement('div');
  legend.className = 'legend';
  for (const [name, picture] of entries) legend.append(button(name, picture, toggle));
  place.before(legend);
}
