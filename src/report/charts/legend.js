// SPDX-License-Identifier: MIT
// One legend for many small charts of a kind.

function sample(stroke, colour) {
  const picture = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  picture.setAttribute('width', '34');
  picture.setAttribute('height', '10');
  picture.setAttribute('aria-hidden', 'true');
  const line = document.createElementNS('http://www.w3.org/2000/svg', 'line');
  const shape = { x1: 0, y1: 5, x2: 34, y2: 5, stroke: colour, 'stroke-width': stroke.width };
  if (Array.isArray(stroke.type)) shape['stroke-dasharray'] = stroke.type.join(' ');
  for (const [name, value] of Object.entries(shape)) line.setAttribute(name, String(value));
  picture.append(line);
  return picture;
}

export function sharedLegend(group, data, theme) {
  group.querySelector('.legend')?.remove();
  const names = new Map();
  for (const place of group.querySelectorAll('.chart'))
    for (const line of data[Number(place.dataset.chart)].lines ?? []) names.set(line.key, line.name);
  const legend = document.createElement('div');
  legend.className = 'legend';
  for (const [key, name] of names) {
    const entry = document.createElement('span');
    entry.append(sample(theme.strokeOf(key), theme.colourOf(key)), name);
    legend.append(entry);
  }
  group.prepend(legend);
}
