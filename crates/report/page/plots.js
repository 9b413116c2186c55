// Plots as SVG, so that they are sharp on every screen and follow the theme.

const PLOT_HEIGHT = 148;
const MARGIN = { left: 40, right: 10, top: 8, bottom: 20 };

// Round numbers that divide a range into about `wanted` parts.
const ticks = (low, high, wanted) => {
  const rough = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 2.5, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, k) => (first + k) * step);
};

// Of more points than pixels the least and the greatest in each column, in the order in which they come.
const thinned = (xs, ys, columns) => {
  if (xs.length <= 2 * columns) return Array.from(xs, (x, k) => [x, ys[k]]);
  const kept = [];
  const size = xs.length / columns;
  for (let column = 0; column < columns; column += 1) {
    const [from, to] = [Math.floor(column * size), Math.floor((column + 1) * size)];
    let [least, most] = [from, from];
    for (let k = from; k < to; k += 1) {
      if (ys[k] < ys[least]) least = k;
      if (ys[k] > ys[most]) most = k;
    }
    for (const k of least === most ? [least] : [Math.min(least, most), Math.max(least, most)]) kept.push([xs[k], ys[k]]);
  }
  return kept;
};

// `draw(box)` returns what is drawn, with box.x and box.y from values to pixels.
const plot = ({ title, note, label, xRange, yRange, yTicks, yFormat, xFormat, xTitle, limits, wide, draw, cursorX, onPick }) => {
  const drawing = svg('svg', { role: 'img', 'aria-label': label });
  const cursor = element('div', { className: 'cursor' });
  const area = element('div', { className: 'plot' }, drawing, cursor);
  const figureElement = element('figure', { className: wide ? 'wide' : '' },
    element('figcaption', {}, element('h2', { textContent: title }), element('p', { textContent: note })), area);
  let box = null;
  const render = () => {
    const width = area.clientWidth;
    if (!width) return;
    const inner = { left: MARGIN.left, right: width - MARGIN.right, top: MARGIN.top, bottom: PLOT_HEIGHT - MARGIN.bottom };
    const span = (range) => range[1] - range[0] || 1;
    box = {
      ...inner,
      columns: Math.max(10, Math.floor(inner.right - inner.left)),
      x: (value) => inner.left + ((value - xRange[0]) / span(xRange)) * (inner.right - inner.left),
      y: (value) => inner.bottom - ((value - yRange[0]) / span(yRange)) * (inner.bottom - inner.top),
    };
    const parts = [];
    for (const value of yTicks) {
      const y = Math.round(box.y(value)) + 0.5;
      parts.push(svg('path', { class: 'rule', d: `M${inner.left} ${y}H${inner.right}` }));
      parts.push(svg('text', { x: inner.left - 6, y: y + 3.5, 'text-anchor': 'end' }, yFormat(value)));
    }
    for (const value of limits || []) {
      const y = Math.round(box.y(value)) + 0.5;
      parts.push(svg('path', { class: 'limit', d: `M${inner.left} ${y}H${inner.right}` }));
    }
    const xs = ticks(xRange[0], xRange[1], Math.max(2, (inner.right - inner.left) / 80));
    for (const value of xs) {
      if (box.x(value) > inner.right - 34 && xTitle) continue;
      parts.push(svg('text', { x: box.x(value), y: PLOT_HEIGHT - 4, 'text-anchor': 'middle' }, xFormat(value)));
    }
    if (xTitle) parts.push(svg('text', { x: inner.right, y: PLOT_HEIGHT - 4, 'text-anchor': 'end' }, xTitle));
    drawing.replaceChildren(...parts, ...draw(box));
    cursor.style.top = `${inner.top}px`;
    cursor.style.height = `${inner.bottom - inner.top}px`;
    if (moved !== null) move(moved);
  };
  let moved = null;
  const move = (time) => {
    moved = time;
    if (box) cursor.style.transform = `translateX(${box.x(cursorX(time))}px)`;
  };
  const pick = (event) => {
    if (!box || (event.type === 'pointermove' && !event.buttons)) return;
    const share = (event.clientX - area.getBoundingClientRect().left - box.left) / (box.right - box.left);
    onPick(xRange[0] + Math.min(1, Math.max(0, share)) * (xRange[1] - xRange[0]));
  };
  area.addEventListener('pointerdown', pick);
  area.addEventListener('pointermove', pick);
  new ResizeObserver(render).observe(area);
  return { figure: figureElement, render, move };
};

const path = (box, points) => points.map(([x, y], k) => `${k ? 'L' : 'M'}${box.x(x).toFixed(1)} ${box.y(y).toFixed(1)}`).join('');

// One line a joint, `ysOf(joint)` at `xs`.
const jointLines = (box, joints, xs, ysOf) => joints.map((_, joint) => svg('path', {
  class: 'series', 'data-joint': joint, stroke: cssRgb(jointColour(joint)), d: path(box, thinned(xs, ysOf(joint), box.columns)),
}));

const column = (values, joint, dof) => Float64Array.from({ length: values.length / dof }, (_, row) => values[row * dof + joint]);

const percent = (value) => `${fixed(value, 0)} %`;

const buildPlots = (data, timeline, seek) => {
  const made = [];
  const time = { xRange: [0, timeline.duration], xFormat: (x) => fixed(x, timeline.duration < 3 ? 1 : 0), xTitle: 't / s', cursorX: (t) => t, onPick: seek };
  if (data.plan) {
    const { motion, peaks } = data.plan;
    const dof = motion.joints.length;
    const { lower, upper } = data.arm.limits;
    // Without a limit, a whole turn (or metre) is what there is to compare with.
    const endless = lower.map((low, joint) => low === null || upper[joint] === null);
    const inRange = (joint) => {
      const [low, high] = endless[joint] ? [-Math.PI, Math.PI] : [lower[joint], upper[joint]];
      return column(motion.positions, joint, dof).map((q) => 100 * (2 * ((q - low) / (high - low)) - 1));
    };
    const positions = motion.joints.map((_, joint) => inRange(joint));
    const farthest = positions.reduce((most, values) => values.reduce((m, v) => Math.max(m, Math.abs(v)), most), 0);
    const far = Math.max(105, farthest * 1.05);
    made.push(plot({
      ...time, title: 'Position', yRange: [-far, far], yTicks: far < 200 ? [-100, -50, 0, 50, 100] : ticks(-far, far, 4), yFormat: (y) => fixed(y, 0), limits: [-100, 100],
      note: endless.every(Boolean) ? '% of half a turn; no limits' : endless.some(Boolean) ? '% from lower to upper limit, or of half a turn' : '% from lower (−100) to upper limit (100)',
      label: `Position of ${dof} joints over time between their limits; at most ${percent(farthest)} of the way from the middle to a limit`,
      draw: (box) => jointLines(box, motion.joints, motion.times, (joint) => positions[joint]),
    }));
    const shares = (title, what, limit, peak, xs, values) => {
      const most = Math.max(1.05, peak * 1.05) * 100;
      made.push(plot({
        ...time, title, yRange: [-most, most], yTicks: [-100, -50, 0, 50, 100], yFormat: (y) => fixed(y, 0), limits: [-100, 100],
        note: `% of the limit, ${fixed(100 * peak, 1)} at most`,
        label: `${title} of ${dof} joints over time as a share of their limits; ${fixed(100 * peak, 1)} % at most`,
        draw: (box) => jointLines(box, motion.joints, xs, (joint) => values(joint).map((v) => (100 * v) / limit[joint])),
      }));
    };
    const { limits } = data.arm;
    shares('Velocity', 'velocity', limits.velocity, peaks[0], motion.times, (joint) => column(motion.velocities, joint, dof));
    shares('Acceleration', 'acceleration', limits.acceleration, peaks[1], motion.times, (joint) => column(motion.accelerations, joint, dof));
    const intervals = motion.times.length - 1;
    const jerkTimes = Float64Array.from({ length: 3 * intervals }, (_, k) => {
      const [from, to] = [motion.times[Math.floor(k / 3)], motion.times[Math.floor(k / 3) + 1]];
      return [from, 0.5 * (from + to), to][k % 3];
    });
    const jerks = (joint) => Float64Array.from({ length: 3 * intervals }, (_, k) => motion.jerks[(Math.floor(k / 3) * dof + joint) * 3 + (k % 3)]);
    shares('Jerk', 'jerk', limits.jerk, peaks[2], jerkTimes, jerks);
  }
  if (data.simulation) {
    const { times, errors } = data.simulation;
    const dof = data.plan.motion.joints.length;
    const worst = errors.reduce((most, error) => Math.max(most, Math.abs(error)), 1e-12) * 1e3;
    made.push(plot({
      ...time, xRange: [0, Math.max(timeline.duration, times[times.length - 1])], title: 'Tracking error', note: `mrad in simulation, ${figure(worst, 3)} at most`,
      yRange: [-1.08 * worst, 1.08 * worst], yTicks: ticks(-worst, worst, 4), yFormat: (y) => figure(y, 3), wide: data.edges.from.length === 0,
      label: `Tracking error of ${dof} joints in simulation over time, ${figure(worst, 3)} mrad at most`,
      draw: (box) => jointLines(box, data.plan.motion.joints, times, (joint) => column(errors, joint, dof).map((e) => 1e3 * e)),
    }));
  }
  if (data.edges.from.length) made.push(epsilonPlot(data, timeline, seek));
  return made;
};

// Each gap's own ε: below 1 the theorem can hold.
const epsilonPlot = (data, timeline, seek) => {
  const { from, epsilons } = data.edges;
  const finite = Array.from(epsilons, (value) => (Number.isFinite(value) ? value : 0));
  const worst = finite.reduce((most, value) => Math.max(most, value), 0);
  const top = Math.max(1.1, Math.min(3, 1.1 * worst));
  const key = (a, b) => `${Math.min(a, b)} ${Math.max(a, b)}`;
  const doubted = new Set(data.doubts.map(({ at: [a, b] }) => key(a, b)));
  const xs = Float64Array.from(finite, (_, k) => k);
  return plot({
    title: 'ε along the curve', note: `gap ÷ 2 reach, ${figure(worst, 3)} at most; below 1 to certify`,
    label: `Epsilon of ${from.length} gaps along the curve, ${figure(worst, 3)} at most; the theorem asks for less than 1`,
    wide: !data.simulation, xRange: [0, Math.max(1, from.length)], xFormat: (x) => fixed(x, 0), xTitle: 'gap', yRange: [0, top],
    yTicks: ticks(0, top, 4), yFormat: (y) => fixed(y, top > 2 ? 0 : 1), limits: [1],
    cursorX: timeline.placeAt, onPick: (x) => seek(timeline.timeOf(from[Math.min(from.length - 1, Math.floor(x))])),
    draw: (box) => {
      const shown = (value) => Math.min(value, top);
      const width = (box.right - box.left) / Math.max(1, from.length);
      const outline = width < 3
        ? path(box, thinned(xs, finite, box.columns).map(([x, y]) => [x + 0.5, shown(y)]))
        : finite.map((y, k) => `${k ? 'L' : 'M'}${box.x(k).toFixed(1)} ${box.y(shown(y)).toFixed(1)}H${box.x(k + 1).toFixed(1)}`).join('');
      const marks = finite.flatMap((y, k) => (doubted.has(key(from[k], data.edges.to[k]))
        ? [svg('circle', { class: 'mark', cx: box.x(k + 0.5), cy: box.y(shown(y)), r: 3 })] : []));
      return [
        svg('path', { class: 'area', d: `${outline}V${box.bottom}H${box.x(width < 3 ? 0.5 : 0)}Z` }),
        svg('path', { class: 'series epsilon', d: outline }),
        ...marks,
      ];
    },
  });
};
