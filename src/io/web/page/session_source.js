// SPDX-License-Identifier: MIT
// Where a session comes from: the program, or the document that it stands in. Both say the same.
import { findToken } from './connection.js';
import { fields, number } from './text.js';

const pixels = 32 * 24;
const blockFrames = 64;  // as they lie in a session file
const mostBlocks = 64;   // that are kept
const noCode = 255;      // of a pixel that is not a number

const bytesOfText = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const objectOf = (bytes) => fields(JSON.parse(new TextDecoder().decode(bytes)));

/** Temperatures of little-endian hundredths of a degree, NaN for the lowest number. */
function ofHundredths(bytes, place) {
  const view = new DataView(bytes.buffer, bytes.byteOffset + place * 2 * pixels, 2 * pixels);
  return Float32Array.from({ length: pixels }, (unused, i) => {
    const value = view.getInt16(2 * i, true);
    return value === -32768 ? NaN : value / 100;
  });
}

/** Temperatures of a packed block: least, step, then a code a pixel, each but the first image's less the one before. */
function ofCodes(block, place) {
  return Float32Array.from(block.codes.subarray(place * pixels, (place + 1) * pixels), (code) => (code === noCode ? NaN : block.least + code * block.step));
}

function unpackedBlock(bytes) {
  const head = new DataView(bytes.buffer, bytes.byteOffset, 8);
  const codes = bytes.slice(8);
  for (let i = pixels; i < codes.length; ++i) codes[i] += codes[i - pixels];
  return { least: head.getFloat32(0, true), step: head.getFloat32(4, true), codes, images: Math.floor(codes.length / pixels) };
}

/** Blocks that were looked at lately; one that is asked for twice at a time is fetched once. */
class Blocks {
  constructor(fetchBlock) {
    this.fetchBlock = fetchBlock;
    this.kept = new Map();
  }

  get(number_) {
    const known = this.kept.get(number_);
    if (known !== undefined) {
      this.kept.delete(number_);
      this.kept.set(number_, known);
      return known;
    }
    const coming = this.fetchBlock(number_).catch((error) => {
      this.kept.delete(number_);
      throw error;
    });
    this.kept.set(number_, coming);
    if (this.kept.size > mostBlocks) this.kept.delete(this.kept.keys().next().value);
    return coming;
  }
}

/** The program's: asked with the token of the address. */
class ServedSession {
  constructor() {
    this.token = findToken();
    this.every = 1;
    this.blocks = new Blocks((block) => this.read(`images/${block}`));
  }

  async read(name) {
    let answer;
    try {
      answer = await fetch(`/data/${name}`, { cache: 'no-store', headers: { Authorization: `Bearer ${this.token}` } });
    } catch {
      throw new Error('The program does not answer: it has ended, or its computer sleeps. Start thermorig view again.');
    }
    if (answer.status === 401) throw new Error('This address is of another program or of an earlier run. Open the address that thermorig printed (it ends with #t=…).');
    if (!answer.ok) throw new Error(`The program answered ${answer.status}.`);
    return new Uint8Array(await answer.arrayBuffer());
  }

  async facts() {
    return objectOf(await this.read('facts'));
  }

  rows() {
    return this.read('rows');
  }

  /** The image of a frame, and of which frame it is. */
  async image(frame) {
    const bytes = await this.blocks.get(Math.floor(frame / blockFrames));
    const place = frame % blockFrames;
    if ((place + 1) * 2 * pixels > bytes.length) throw new Error(`The program sent no image of frame ${frame}.`);
    return { frame, temperatures: ofHundredths(bytes, place), precision: null };
  }

  /** What may be looked at next. */
  prepare(frame) {
    this.blocks.get(Math.floor(frame / blockFrames)).catch(() => {});
  }

  leftOut() {
    return '';
  }
}

const partOf = (name) => document.getElementById(`data-${name}`);

/** The document's own. */
class ContainedSession {
  constructor() {
    this.packing = objectOf(bytesOfText(partOf('packing').textContent));
    this.every = Math.max(1, Math.round(number(this.packing.every) ?? 1));
    this.blocks = new Blocks(async (block) => unpackedBlock(await this.read(`images-${block}`)));
  }

  async read(name) {
    const part = partOf(name);
    if (part === null) throw new Error(`This file has no ${name.replace('-', ' ')}.`);
    return inflated(bytesOfText(part.textContent));
  }

  async facts() {
    return objectOf(await this.read('facts'));
  }

  rows() {
    return this.read('rows');
  }

  async image(frame) {
    const place = Math.floor(frame / this.every);
    const block = await this.blocks.get(Math.floor(place / blockFrames));
    if (place % blockFrames >= block.images) throw new Error(`This file has no image of frame ${frame}.`);
    return { frame: place * this.every, temperatures: ofCodes(block, place % blockFrames), precision: block.step / 2 };
  }

  prepare() {}

  leftOut() {
    return typeof this.packing.left_out === 'string' ? this.packing.left_out : '';
  }
}

export function findSource() {
  return partOf('facts') === null ? new ServedSession() : new ContainedSession();
}
