// check.mjs NAME PAGE.html [FILE.json | FOLDER]: one test of a page; exits with an assertion that failed.

import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { contrasts, open, withBrowser } from './browser.mjs';

const [name, file, given] = process.argv.slice(2);
const far = (a, b) => a.reduce((most, x, k) => Math.max(most, Math.abs(x - b[k])), 0);
const time = (page) => page.evaluate(() => window.report.time);

const tests = {
  // `given`: [{time_s, links: {name: sixteen numbers}}], from the planner's own kinematics.
  async arm(browser) {
    const { page, close } = await open(browser, file);
    const expected = JSON.parse(readFileSync(given, 'utf8'));
    let moved = 0;
    let before = null;
    for (const { time_s: wanted, links } of expected) {
      await page.locator('#time').fill(String(wanted));
      const drawn = await page.evaluate(() => window.report.linkTransforms());
      for (const [link, transform] of Object.entries(links)) {
        const error = far(drawn[link], transform);
        assert.ok(error <= 1e-5, `${link} at ${wanted} s is off by ${error}`);
      }
      if (before) moved = Math.max(moved, far(drawn.tool0, before));
      before = drawn.tool0;
    }
    assert.ok(moved > 0.05, `the tool moved by ${moved} only`);
    await close();
  },

  async keyboard(browser) {
    const { page, close } = await open(browser, file, { reducedMotion: 'reduce' });
    const steps = [['ArrowRight', 0.1], ['ArrowRight', 0.2], ['ArrowLeft', 0.1]];
    for (const [key, after] of steps) {
      await page.keyboard.press(key);
      assert.ok(Math.abs(await time(page) - after) < 1e-9, `${key} led to ${await time(page)}`);
    }
    // From the beginning, every control is reached by tabs and is seen to have the focus.
    const reached = new Set();
    for (let k = 0; k < 60; k += 1) {
      await page.keyboard.press('Tab');
      const focus = await page.evaluate(() => {
        const at = document.activeElement;
        const outlined = at.matches('input[type="radio"]') ? at.nextElementSibling : at;
        return { id: at.id || at.name || at.textContent.trim(), named: Boolean(at.ariaLabel || at.labels?.length || at.textContent.trim() || at.getAttribute('aria-describedby')), outline: getComputedStyle(outlined).outlineStyle, body: at === document.body };
      });
      if (focus.body) break;
      assert.notEqual(focus.outline, 'none', `${focus.id} does not show its focus`);
      assert.ok(focus.named, `${focus.id} has no name`);
      reached.add(focus.id);
    }
    for (const id of ['theme', 'colouring', 'stage', 'time', 'play', 'speed', 'Whole']) assert.ok(reached.has(id), `${id} is not reached: ${[...reached]}`);
    await page.locator('#time').focus();
    await page.keyboard.press('End');
    assert.equal(await time(page), await page.evaluate(() => window.report.duration));
    await page.keyboard.press('Home');
    // Space plays, and the time goes on by itself; space again stops it.
    await page.keyboard.press(' ');
    assert.equal(await page.getByRole('button', { name: 'Pause' }).count(), 1);
    await page.waitForFunction(() => window.report.time > 0.05);
    await page.keyboard.press(' ');
    const stopped = await time(page);
    await page.evaluate(() => new Promise((frame) => { requestAnimationFrame(() => requestAnimationFrame(frame)); }));
    assert.equal(await time(page), stopped);
    const dark = await page.evaluate(() => window.report.dark);
    await page.keyboard.press('t');
    assert.equal(await page.evaluate(() => window.report.dark), !dark);
    await close();
  },

  // `given`: [a, b], rows of a doubt of the page.
  async doubt(browser) {
    for (const colorScheme of ['light', 'dark']) {
      const { page, close } = await open(browser, file, { colorScheme, reducedMotion: 'reduce' });
      const [a, b] = JSON.parse(given);
      await page.getByRole('button', { name: `${a} – ${b}` }).first().click();
      // It comes with the next frame that is drawn.
      await page.locator('#note').waitFor();
      assert.match(await page.locator('#note').textContent(), new RegExp(`^${a} – ${b}.{10}`));
      await page.locator('.layers').getByText('Poses').click();
      const [red, green, blue] = await page.evaluate(([i, j]) => {
        const [from, to] = [window.report.onStage(i), window.report.onStage(j)];
        return window.report.pixel(0.5 * (from.x + to.x), 0.5 * (from.y + to.y));
      }, [a, b]);
      assert.ok(red > 180 && green < 0.6 * red && blue < 0.6 * red, `${colorScheme}: the doubtful edge is drawn in ${[red, green, blue]}`);
      await page.locator('.layers').getByText('Doubts').click();
      const without = await page.evaluate(([i, j]) => {
        const [from, to] = [window.report.onStage(i), window.report.onStage(j)];
        return window.report.pixel(0.5 * (from.x + to.x), 0.5 * (from.y + to.y));
      }, [a, b]);
      assert.ok(without[0] < 1.5 * without[1], `without doubts there is still red: ${without}`);
      await close();
    }
  },

  // `given`: a folder for pictures.
  light: (browser) => looks(browser, 'light'),
  dark: (browser) => looks(browser, 'dark'),

  // `given`: {name, says: [...], refused} that must be on the page as they are.
  async words(browser) {
    const { page, close } = await open(browser, file);
    const expected = JSON.parse(given);
    assert.equal(await page.locator('#name').textContent(), expected.name);
    const text = await page.locator('body').innerText();
    for (const sentence of expected.says) assert.ok(text.includes(sentence), `${sentence} is not on the page`);
    assert.equal(await page.locator('#refusal').isVisible(), Boolean(expected.refused));
    assert.equal(await page.evaluate(() => window.broken), undefined);
    await page.keyboard.press('ArrowRight');
    assert.ok(await time(page) > 0);
    await close();
  },

  // How fast it is depends on who else wants the processor, which draws here; how much there is to draw does not.
  async pace(browser) {
    const { page, close } = await open(browser, file);
    const { calls, rate } = await page.evaluate(async () => {
      const { report } = window;
      report.setPlaying(true);
      const [from, begun] = [report.framesDrawn, performance.now()];
      while (performance.now() - begun < 3000) await new Promise(requestAnimationFrame);
      return { calls: report.drawCalls(), rate: (1000 * (report.framesDrawn - from)) / (performance.now() - begun) };
    });
    console.log(`${rate.toFixed(1)} frames a second in ${calls} draw calls`);
    assert.ok(rate > 0 && calls < 12, `${calls} draw calls, ${rate} frames a second`);
    await close();
  },
};

const looks = async (browser, colorScheme) => {
  mkdirSync(given, { recursive: true });
  const isLegible = async (page, what) => {
    // Colours that are still on their way are nobody's choice.
    await page.evaluate(() => Promise.all(document.getAnimations().map((animation) => animation.finished)));
    const texts = await contrasts(page);
    assert.ok(texts.length > 60, `only ${texts.length} texts are seen`);
    assert.deepEqual(texts.filter(({ ratio }) => !(ratio >= 4.5)), [], `${colorScheme} ${what}`);
  };
  const fits = async (page, width) => {
    const needed = await page.evaluate(() => document.scrollingElement.scrollWidth);
    assert.ok(needed <= width, `${needed} pixels wide on ${width}`);
  };
  for (const [device, width, height, deviceScaleFactor] of [['desktop', 1280, 800, 1], ['phone', 390, 844, 2]]) {
    const { page, close } = await open(browser, file, { width, height, deviceScaleFactor, colorScheme, hasTouch: width < 600 });
    await page.evaluate(() => window.report.setTime(0.4 * window.report.duration));
    await fits(page, width);
    await isLegible(page, device);
    assert.equal(await page.evaluate(() => window.report.dark), colorScheme === 'dark');
    await page.screenshot({ path: `${given}/${device}-${colorScheme}.png` });
    if (device === 'desktop') {
      // The switch goes against the system's choice, and what it leads to is as legible.
      await page.locator('#theme').click();
      assert.equal(await page.evaluate(() => window.report.dark), colorScheme !== 'dark');
      await isLegible(page, 'after the switch');
    } else {
      await page.setViewportSize({ width: 360, height: 740 });
      await fits(page, 360);
    }
    await close();
  }
};

await withBrowser(tests[name]);
