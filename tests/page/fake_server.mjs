// SPDX-License-Identifier: MIT
// Serves the built files of the page and whatever messages a test wants to send, as the program does.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';

export const token = '0123456789abcdef0123456789abcdef';
const policy = "default-src 'self'; connect-src 'self' ws://127.0.0.1:*; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
const files = { '/': ['index.html', 'text/html; charset=utf-8'], '/page.js': ['page.js', 'text/javascript; charset=utf-8'],
  '/page.css': ['page.css', 'text/css; charset=utf-8'], '/icon.svg': ['icon.svg', 'image/svg+xml'], '/licences.txt': ['licences.txt', 'text/plain; charset=utf-8'] };

/** A frame of the WebSocket protocol from server to client. */
function packed(opcode, payload) {
  const head = payload.length < 126 ? Buffer.from([0x80 | opcode, payload.length])
    : payload.length < 65536 ? Buffer.from([0x80 | opcode, 126, payload.length >> 8, payload.length & 255]) : Buffer.alloc(10);
  if (head.length === 10) {
    head[0] = 0x80 | opcode;
    head[1] = 127;
    head.writeBigUInt64BE(BigInt(payload.length), 2);
  }
  return Buffer.concat([head, payload]);
}

/** The text of a client's first, short frame; empty for anything else. */
function unpacked(bytes) {
  if (bytes.length < 6 || (bytes[0] & 15) !== 1 || (bytes[1] & 127) > 125) return '';
  const mask = bytes.subarray(2, 6);
  return bytes.subarray(6, 6 + (bytes[1] & 127)).map((byte, i) => byte ^ mask[i % 4]).toString();
}

export class FakeServer {
  constructor(folder) {
    this.folder = folder;
    this.sockets = new Set();  // all
    this.streams = new Set();  // those that have shown the token
    this.greeting = [];        // messages for each new stream
    this.posts = [];
    this.answer = { status: 204, body: '' };
  }

  async open(port = 0) {
    this.server = createServer((request, response) => this.serve(request, response));
    this.server.on('upgrade', (request, socket) => this.upgrade(request, socket));
    this.server.on('connection', (socket) => {
      this.sockets.add(socket);
      socket.on('error', () => {});
      socket.on('close', () => this.sockets.delete(socket));
    });
    await new Promise((done) => this.server.listen(port, '127.0.0.1', done));
    this.port = this.server.address().port;
    this.url = `http://127.0.0.1:${this.port}/#t=${token}`;
    return this;
  }

  /** As a program that was killed. */
  async close() {
    for (const socket of this.sockets) socket.destroy();
    this.streams.clear();
    await new Promise((done) => this.server.close(done));
  }

  serve(request, response) {
    if (request.method === 'POST') {
      let body = '';
      request.on('data', (part) => { body += part; });
      request.on('end', () => {
        this.posts.push({ path: request.url, headers: request.headers, body });
        response.writeHead(this.answer.status, { 'Content-Type': 'application/json' }).end(this.answer.body);
      });
      return;
    }
    const file = files[request.url];
    if (file === undefined) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { 'Content-Type': file[1], 'Content-Encoding': 'gzip', 'Content-Security-Policy': policy,
      'X-Content-Type-Options': 'nosniff', 'Cache-Control': 'no-store' }).end(readFileSync(join(this.folder, `${file[0]}.gz`)));
  }

  upgrade(request, socket) {
    const accept = createHash('sha1').update(`${request.headers['sec-websocket-key']}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest('base64');
    socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
    socket.once('data', (bytes) => {
      let shown;
      try {
        shown = JSON.parse(unpacked(bytes)).token;
      } catch {
        shown = undefined;
      }
      if (shown !== token) {
        socket.end(packed(8, Buffer.from([1008 >> 8, 1008 & 255])));
        return;
      }
      this.streams.add(socket);
      socket.on('close', () => this.streams.delete(socket));
      for (const message of this.greeting) this.sendTo(socket, message);
    });
  }

  sendTo(socket, message) {
    socket.write(packed(1, Buffer.from(typeof message === 'string' ? message : JSON.stringify(message))));
  }

  send(...messages) {
    for (const message of messages) for (const socket of this.streams) this.sendTo(socket, message);
  }
}
