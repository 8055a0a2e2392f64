// SPDX-License-Identifier: MIT
// Makes assets.cpp, the table of the page's files, and the same files in a folder beside it for the browser tests.
// Usage: node build.mjs <folder of the sources> <assets.cpp to write>   (in the folder of node_modules)
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

const [source, target] = process.argv.slice(2).map((path) => resolve(path));
const read = (name) => readFileSync(join(source, name));

async function bundle(entry, options) {
  const { outputFiles } = await build({ entryPoints: [entry], bundle: true, minify: true, write: false, legalComments: 'none',
    charset: 'ascii', nodePaths: [resolve('node_modules')], absWorkingDir: source, logLevel: 'warning', ...options });
  return Buffer.from(outputFiles[0].contents);
}

const files = [
  ['/', 'index.html', 'text/html; charset=utf-8', read('page.html')],
  ['/page.js', 'page.js', 'text/javascript; charset=utf-8', await bundle('page.js', { format: 'iife', target: 'es2022' })],
  ['/page.css', 'page.css', 'text/css; charset=utf-8',
    await bundle('page.css', { target: ['chrome100', 'firefox100', 'safari15.4'] })],
  ['/session', 'session.html', 'text/html; charset=utf-8', read('session.html')],
  ['/session.js', 'session.js', 'text/javascript; charset=utf-8', await bundle('session.js', { format: 'iife', target: 'es2022' })],
  ['/session.css', 'session.css', 'text/css; charset=utf-8',
    await bundle('session.css', { target: ['chrome100', 'firefox100', 'safari15.4'] })],
  ['/icon.svg', 'icon.svg', 'image/svg+xml', read('icon.svg')],
  ['/licences.txt', 'licences.txt', 'text/plain; charset=utf-8',
    Buffer.from(`uPlot (https://github.com/leeoniya/uPlot)\n\n${readFileSync('node_modules/uplot/LICENSE', 'utf8').trim()}\n`)],
];

/** The session's page as a document of its own: what is loaded stands in it, and the policy lets in nothing else. */
function documentPieces() {
  const text = (path) => files.find(([name]) => name === path)[3].toString('utf8');
  const style = text('/session.css');
  const script = text('/session.js');
  if (/<\/script|<!--/i.test(script) || /<\/style/i.test(style)) throw new Error('a bundle would end its own element');
  const sum = createHash('sha256').update(script).digest('base64');
  const policy = `default-src 'none'; script-src 'sha256-${sum}'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'`;
  const licences = text('/licences.txt').replace(/[&<]/g, (c) => (c === '&' ? '&amp;' : '&lt;'));
  const replace = (page, what, by) => {
    if (page.split(what).length !== 2) throw new Error(`session.html has to have once: ${what}`);
    return page.split(what).join(by);
  };
  let page = text('/session');
  page = replace(page, '<meta charset="utf-8">', `<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="${policy}">`);
  page = replace(page, '<link rel="icon" href="/icon.svg" type="image/svg+xml">\n', '');
  page = replace(page, '<link rel="stylesheet" href="/session.css">', `<style>${style}</style>`);
  page = replace(page, '<script src="/session.js" defer></script>\n', '');
  page = replace(page, '<a href="/licences.txt">licences</a>', `<details><summary>licences</summary><pre>${licences}</pre></details>`);
  page = replace(page, '</body>', `{{data}}<script>${script}</script>\n</body>`);
  const [beforeTitle, behindTitle] = page.split(/(?<=<title>)thermorig(?=<\/title>)/);
  return [beforeTitle, ...behindTitle.split('{{data}}')];
}

/** The same bytes wherever it is built: no time, no operating system. */
function gzip(bytes) {
  const packed = gzipSync(bytes, { level: 9 });
  packed.fill(0, 4, 8);
  packed[9] = 255;
  return packed;
}

const etag = (bytes) => `"${createHash('sha256').update(bytes).digest('hex').slice(0, 32)}"`;

/** As C++ string literals; every byte that is not plain ASCII as three octal digits. */
function literal(bytes) {
  const escape = (byte) => (byte === 0x22 || byte === 0x5c || byte === 0x3f ? `\\${String.fromCharCode(byte)}`
    : byte >= 0x20 && byte < 0x7f ? String.fromCharCode(byte) : `\\${byte.toString(8).padStart(3, '0')}`);
  const escaped = [...bytes].map(escape);
  const lines = [];
  for (let i = 0; i < escaped.length; i += 120) lines.push(`    "${escaped.slice(i, i + 120).join('')}"`);
  return lines.join('\n');
}

const folder = join(dirname(target), 'files');
mkdirSync(folder, { recursive: true });
const entries = files.map(([path, name, type, plain]) => {
  const packed = gzip(plain);
  writeFileSync(join(folder, name), plain);
  writeFileSync(join(folder, `${name}.gz`), packed);
  return `    {"${path}"sv,
     {"${type}"sv, ${JSON.stringify(etag(plain))}sv, std::string_view(
${literal(packed)},
      ${packed.length}), std::string_view(
${literal(plain)},
      ${plain.length})}},`;
});

const pieces = documentPieces().map((piece) => Buffer.from(piece));
if (pieces.length !== 3) throw new Error('a document of its own has three pieces');

writeFileSync(target, `// Made by src/io/web/page/build.mjs.
#include "assets.h"

#include <array>
#include <utility>

namespace thermorig::web {

namespace {

using namespace std::string_view_literals;

constexpr std::array<std::pair<std::string_view, Asset>, ${files.length}> assets{{
${entries.join('\n')}
}};

}  // namespace

const bool has_page = true;

const std::array<std::string_view, 3> document_pieces{{
${pieces.map((piece) => `    std::string_view(\n${literal(piece)},\n      ${piece.length})`).join(',\n')}
}};

std::optional<Asset> asset(std::string_view path) {
  for (const auto& [name, file] : assets) {
    if (name == path) return file;
  }
  return std::nullopt;
}

}  // namespace thermorig::web
`);
