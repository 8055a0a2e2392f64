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
  ['/icon.svg', 'icon.svg', 'image/svg+xml', read('icon.svg')],
  ['/licences.txt', 'licences.txt', 'text/plain; charset=utf-8',
    Buffer.from(`uPlot (https://github.com/leeoniya/uPlot)\n\n${readFileSync('node_modules/uplot/LICENSE', 'utf8').trim()}\n`)],
];

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

std::optional<Asset> asset(std::string_view path) {
  for (const auto& [name, file] : assets) {
    if (name == path) return file;
  }
  return std::nullopt;
}

}  // namespace thermorig::web
`);
