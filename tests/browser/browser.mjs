// The Chromium of the set-up, driven by Playwright, and what every test asks of a page.

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const home = join(import.meta.dirname, '../../.deps/browser');
const { chromium } = createRequire(join(home, 'package.json'))('playwright-core');
const folder = join(home, 'chromium');

// Drawing is done by the processor: there need be no graphics card.
const ARGUMENTS = ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];
// The first frame waits for shaders to be compiled, on a busy machine for long.
const PATIENCE_MS = 90_000;

export const withBrowser = async (work) => {
  const env = { ...process.env, LD_LIBRARY_PATH: join(folder, 'lib'), FONTCONFIG_FILE: join(folder, 'fonts.conf') };
  const browser = await chromium.launch({ executablePath: join(folder, 'chromium'), args: ARGUMENTS, env });
  try {
    await work(browser);
  } finally {
    await browser.close();
  }
};

// Opens a page that must load whole, ask for nothing and complain of nothing, until `close` is called.
export const open = async (browser, file, { width = 1280, height = 800, ...options } = {}) => {
  const context = await browser.newContext({ viewport: { width, height }, ...options });
  context.setDefaultTimeout(PATIENCE_MS);
  const page = await context.newPage();
  const url = pathToFileURL(file).href;
  const complaints = [];
  page.on('console', (message) => {
    // Reading a pixel makes the driver wait, and say so; only a test does that.
    if (['error', 'warning'].includes(message.type()) && !message.text().includes('GPU stall due to ReadPixels')) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(error.stack));
  page.on('request', (request) => {
    if (request.url() !== url && !request.url().startsWith('data:')) complaints.push(`a request for ${request.url()}`);
  });
  await page.goto(url);
  await page.waitForFunction(() => window.report?.framesDrawn > 0);
  const close = async () => {
    assert.deepEqual(complaints, []);
    await context.close();
  };
  return { page, close };
};

// Every text that is seen, with the contrast to what is behind it (WCAG 2.2, relative luminance).
export const contrasts = (page) => page.evaluate(() => {
  const channels = (colour) => {
    const numbers = colour.match(/[\d.]+/g).map(Number);
    return { rgb: numbers.slice(0, 3), alpha: numbers[3] ?? 1 };
  };
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((x) => (x / 255 <= 0.04045 ? x / 255 / 12.92 : ((x / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const { rgb, alpha } = channels(getComputedStyle(at).backgroundColor);
      if (alpha === 1) return rgb;
      if (alpha > 0) throw new Error(`${at.tagName} is half transparent`);
    }
    return [255, 255, 255];
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const found = [];
  while (walker.nextNode()) {
    const { parentElement: element, textContent } = walker.currentNode;
    if (!textContent.trim() || element.closest('script, style, noscript, [hidden], .unseen, .skip') || !element.getClientRects().length) continue;
    const style = getComputedStyle(element);
    const ink = channels(element instanceof SVGElement ? style.fill : style.color).rgb;
    const [low, high] = [luminance(ink), luminance(behind(element))].sort((a, b) => a - b);
    found.push({ text: textContent.trim().slice(0, 40), ratio: (high + 0.05) / (low + 0.05) });
  }
  return found;
});
