// SPDX-License-Identifier: MIT
// What one sees, as a PNG: the images and plots that are drawn, the words beside them, and the lines of the legends.
import { byId, say } from './text.js';

const least = 2;  // pixels of the picture for one of the page, so that it can be printed

/** Each word that is drawn: its text, its place and how it looks. */
function* wordsIn(part) {
  const walker = document.createTreeWalker(part, NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  while (walker.nextNode()) {
    const node = walker.currentNode;
    const style = getComputedStyle(node.parentElement);
    if (style.visibility === 'hidden' || node.parentElement.closest('.unseen') !== null) continue;
    for (const { 0: text, index } of node.data.matchAll(/\S+/g)) {
      range.setStart(node, index);
      range.setEnd(node, index + text.length);
      const box = range.getBoundingClientRect();
      if (box.width > 0) yield { text, box, style };
    }
  }
}

function drawLine(context, line) {
  const style = getComputedStyle(line);
  if (style.visibility === 'hidden') return;
  const box = line.getBoundingClientRect();
  if (box.width === 0) return;
  context.strokeStyle = style.stroke;
  context.lineWidth = parseFloat(style.strokeWidth);
  context.setLineDash(style.strokeDasharray === 'none' ? [] : style.strokeDasharray.split(/[ ,]+/).map(parseFloat));
  context.beginPath();
  context.moveTo(box.left, (box.top + box.bottom) / 2);
  context.lineTo(box.right, (box.top + box.bottom) / 2);
  context.stroke();
  context.setLineDash([]);
}

/** Grounds of words are not drawn, so none may be in the colour of the paper. */
function ink(style) {
  const body = getComputedStyle(document.body);
  return [body.backgroundColor, 'rgb(255, 255, 255)'].includes(style.color) ? body.color : style.color;
}

/** Band and content, but not the buttons below them. */
function drawPage() {
  const parts = [document.querySelector('.band'), document.querySelector('main')];
  const boxes = parts.map((part) => part.getBoundingClientRect());
  const top = Math.min(...boxes.map((box) => box.top));
  const canvas = document.createElement('canvas');
  const scale = Math.max(least, devicePixelRatio);
  canvas.width = Math.round(document.documentElement.clientWidth * scale);
  canvas.height = Math.round((Math.max(...boxes.map((box) => box.bottom)) - top) * scale);
  const context = canvas.getContext('2d');
  context.scale(scale, scale);
  context.translate(0, -top);
  context.fillStyle = getComputedStyle(document.body).backgroundColor;
  context.fillRect(0, top, canvas.width, canvas.height);
  for (const part of parts) {
    for (const drawn of part.querySelectorAll('canvas')) {
      const box = drawn.getBoundingClientRect();
      if (box.width === 0 || drawn.width === 0 || drawn.height === 0) continue;
      context.imageSmoothingEnabled = getComputedStyle(drawn).imageRendering !== 'pixelated';
      context.drawImage(drawn, box.left, box.top, box.width, box.height);
    }
    for (const line of part.querySelectorAll('button svg line, #servo svg line')) drawLine(context, line);
    context.textBaseline = 'middle';
    for (const { text, box, style } of wordsIn(part)) {
      context.font = `${style.fontStyle} ${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
      context.fillStyle = ink(style);
      context.fillText(text, box.left, (box.top + box.bottom) / 2, box.width);
    }
  }
  return canvas;
}

/** The band stands above the content, wherever the page is scrolled to. */
function drawUnscrolled() {
  const { style } = document.querySelector('.band');
  style.position = 'static';
  try {
    return drawPage();
  } finally {
    style.position = '';
  }
}

/** Hands the picture to the browser as a file. */
export function savePicture() {
  const canvas = drawUnscrolled();
  canvas.toBlob((blob) => {
    if (blob === null) {
      say(byId('announcement'), 'This browser could not make a picture');
      return;
    }
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = `thermorig_${new Date().toISOString().replaceAll(/[-:]|\..*/g, '')}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    say(byId('announcement'), 'Picture saved');
  }, 'image/png');
}
