// What is said rather than drawn: figures at the top, statements, doubts, and the joints at this moment.

// Doubts that get a line of their own; the picture shows all.
const LISTED_DOUBTS = 200;

const wording = { certified: 'good', plausible: '', ambiguous: 'bad' };

const showFigures = (data) => {
  const tile = (what, value, unit = '', kind = '') => {
    const number = element('dd', {}, value);
    if (unit) number.append(' ', element('small', { textContent: unit }));
    byId('figures').append(element('div', { className: kind }, element('dt', { textContent: what }), number));
  };
  tile('points', String(data.n));
  tile('verdict', data.verdict, '', wording[data.verdict]);
  tile(data.doubts.length === 1 ? 'doubt' : 'doubts', String(data.doubts.length), '', data.doubts.length ? 'bad' : '');
  const worst = data.edges.epsilons.reduce((most, value) => (Number.isFinite(value) ? Math.max(most, value) : most), 0);
  if (data.edges.epsilons.length) tile('greatest ε', figure(worst, 2));
  if (data.plan) {
    const { motion, peaks } = data.plan;
    tile('duration', fixed(motion.times[motion.times.length - 1], 2), 's');
    tile('peaks of v · a · j limits', peaks.map((peak) => fixed(100 * peak, 0)).join(' · '), '%', peaks.some((peak) => peak > 1) ? 'bad' : '');
  }
  if (data.simulation) {
    const worstError = data.simulation.errors.reduce((most, error) => Math.max(most, Math.abs(error)), 0);
    tile('tracking at worst', figure(1e3 * worstError, 3), 'mrad');
  }
};

const panel = (title, ...content) => {
  const id = `panel-${title.toLowerCase().replace(/\W+/g, '-')}`;
  const section = element('section', { 'aria-labelledby': id }, element('h2', { id, textContent: title }), ...content);
  byId('words').append(section);
  return section;
};

const statements = (said) => {
  const list = element('dl');
  let before = null;
  for (const { about, says } of said) {
    // A word that stands for several lines is said once to the eye, and every time to the ear.
    list.append(element('dt', {}, about === before ? element('span', { className: 'unseen', textContent: about }) : about), element('dd', { textContent: says }));
    before = about;
  }
  return list;
};

const showDoubts = (data, choose) => {
  if (!data.doubts.length) return;
  const list = element('ol', { className: 'doubts' });
  data.doubts.slice(0, LISTED_DOUBTS).forEach(({ at: [a, b], why }, k) => {
    const button = element('button', { type: 'button', 'aria-pressed': 'false' }, element('b', { textContent: `${a} – ${b}` }), ` ${why}`);
    button.addEventListener('click', () => choose(k));
    list.append(element('li', {}, button));
  });
  if (data.doubts.length > LISTED_DOUBTS) list.append(element('li', {}, element('p', { textContent: `and ${data.doubts.length - LISTED_DOUBTS} more, all drawn in red` })));
  panel(`Doubts (${data.doubts.length})`, list);
};

// The table of joints, which is the plots' legend too. Returns what brings it up to date.
const showJoints = (data, timeline) => {
  if (!data.plan) return () => {};
  const { joints } = data.plan.motion;
  const { limits } = data.arm;
  const heads = ['joint', 'q\nrad', 'v\nrad/s', 'a\nrad/s²', 'j\nrad/s³'];
  const head = element('tr', {}, ...heads.map((text) => {
    const [name, unit] = text.split('\n');
    const cell = element('th', { scope: 'col' }, name);
    if (unit) cell.append(element('br'), unit);
    return cell;
  }));
  const slides = data.arm.links.filter(({ axis }) => axis).map((link) => link.slides);
  const shown = joints.every((name) => name.endsWith('_joint')) ? joints.map((name) => name.slice(0, -6)) : joints;
  const rows = joints.map((name, joint) => {
    const button = element('button', { type: 'button', 'aria-pressed': 'false', title: limitsOf(name, limits, joint, slides[joint]) }, element('i'), element('span', { textContent: shown[joint] }));
    button.addEventListener('click', () => {
      const pressed = button.getAttribute('aria-pressed') !== 'true';
      rows.forEach((row) => row.button.setAttribute('aria-pressed', 'false'));
      button.setAttribute('aria-pressed', String(pressed));
      highlight(pressed ? joint : null);
    });
    const cells = [0, 1, 2, 3].map(() => element('td'));
    return { button, cells, row: element('tr', {}, element('th', { scope: 'row' }, button), ...cells) };
  });
  const table = element('table', {}, element('thead', {}, head), element('tbody', {}, ...rows.map(({ row }) => row)));
  panel('Joints', element('div', { className: 'scroller' }, table));
  const paint = () => rows.forEach(({ button }, joint) => { button.firstChild.style.color = cssRgb(jointColour(joint)); });
  const set = (time) => {
    timeline.jointsAt(time).forEach(({ position, velocity, acceleration, jerk }, joint) => {
      const texts = [fixed(position, 3), fixed(velocity, 3), fixed(acceleration, 2), fixed(jerk, 1)];
      rows[joint].cells.forEach((cell, k) => { if (cell.textContent !== texts[k]) cell.textContent = texts[k]; });
    });
  };
  set.paint = paint;
  paint();
  return set;
};

const limitsOf = (name, limits, joint, slides) => {
  const unit = slides ? 'm' : 'rad';
  const range = limits.lower[joint] === null || limits.upper[joint] === null ? 'endless' : `${fixed(limits.lower[joint], 3)} to ${fixed(limits.upper[joint], 3)} ${unit}`;
  return `${name}: ${range}; at most ${figure(limits.velocity[joint])} ${unit}/s, ${figure(limits.acceleration[joint])} ${unit}/s², ${figure(limits.jerk[joint])} ${unit}/s³`;
};

const highlight = (joint) => {
  document.querySelectorAll('.series[data-joint]').forEach((line) => {
    line.classList.toggle('faded', joint !== null && Number(line.dataset.joint) !== joint);
  });
};

const showWords = (data, timeline, chooseDoubt) => {
  byId('name').textContent = data.name;
  byId('shape').textContent = data.arm ? `${data.shape}, for ${data.arm.name}` : data.shape;
  if (data.refusal) {
    byId('refusal').hidden = false;
    byId('refusal-text').textContent = data.refusal;
  }
  showFigures(data);
  const setJoints = showJoints(data, timeline);
  showDoubts(data, chooseDoubt);
  panel('Certificate', statements(data.certificate));
  if (data.plan) panel('Plan', statements(data.plan.statements));
  if (data.simulation) panel('Simulation', statements(data.simulation.statements));
  return setJoints;
};
