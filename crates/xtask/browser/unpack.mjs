// Unpacks the Chromium of @sparticuz/chromium, which is compressed for a service that unpacks it at every start, into ./chromium.

import { execFileSync } from 'node:child_process';
import { createReadStream, createWriteStream, mkdirSync, chmodSync, rmSync, writeFileSync } from 'node:fs';
import { pipeline } from 'node:stream/promises';
import { createBrotliDecompress } from 'node:zlib';

const packed = 'node_modules/@sparticuz/chromium/bin';
const unpack = (from, to) => pipeline(createReadStream(`${packed}/${from}.br`), createBrotliDecompress(), createWriteStream(to));

mkdirSync('chromium');
await unpack('chromium', 'chromium/chromium');
chmodSync('chromium/chromium', 0o755);
// Libraries that a machine may lack (nss, expat), drawing without a graphics card, a font.
for (const archive of ['al2023.tar', 'swiftshader.tar', 'fonts.tar']) {
  await unpack(archive, archive);
  execFileSync('tar', ['-xf', archive, '-C', 'chromium', '--no-same-owner']);
  rmSync(archive);
}
// With that font alone, so that pictures are the same on every machine.
writeFileSync('chromium/fonts.conf', `<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig><dir prefix="relative">fonts</dir><cachedir prefix="relative">fonts-cache</cachedir></fontconfig>
`);
rmSync('node_modules/@sparticuz', { recursive: true });
