// Puts the parts together: time, keys, theme, and `window.report` for whoever drives the page from outside.

const data = readData();
const timeline = timelineOf(data);
let chosen = null;
let time = 0;
let playing = false;

const showJointsAt = showWords(data, timeline, (doubt) => chooseDoubt(chosen === doubt ? null : doubt));
const picture = buildScene(data, timeline);
const plots = buildPlots(data, timeline, (wanted) => setTime(wanted));
byId('charts').append(...plots.map(({ figure: drawn }) => drawn));

// Time.
const slider = byId('time');
slider.max = String(timeline.duration);
const clock = byId('now');
const passedPose = () => Math.min(data.n, Math.floor(timeline.placeAt(time) + 1e-6) + 1);
const setTime = (wanted) => {
  time = Math.min(timeline.duration, Math.max(0, wanted));
  slider.value = String(time);
  const pose = `pose ${passedPose()} of ${data.n}`;
  const seconds = timeline.unit === 's' ? `${fixed(time, 2)} s` : null;
  clock.replaceChildren(...(seconds ? [seconds, element('small', { textContent: pose })] : [pose]));
  slider.setAttribute('aria-valuetext', seconds ? `${seconds} of ${fixed(timeline.duration, 2)} s, ${pose}` : pose);
  showJointsAt(time);
  plots.forEach(({ move }) => move(time));
  if (picture) picture.set(time);
};
slider.addEventListener('input', () => setTime(Number(slider.value)));

const playButton = byId('play');
let lastFrame = 0;
const tick = (now) => {
  if (!playing) return;
  const speed = timeline.perSecond * Number(byId('speed').value);
  setTime(time + (speed * (now - lastFrame)) / 1000);
  lastFrame = now;
  if (time >= timeline.duration) setPlaying(false);
  else requestAnimationFrame(tick);
};
const setPlaying = (wanted) => {
  if (wanted === playing) return;
  playing = wanted;
  playButton.classList.toggle('playing', playing);
  playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
  if (!playing) return;
  if (time >= timeline.duration) setTime(0);
  lastFrame = performance.now();
  requestAnimationFrame(tick);
};
playButton.addEventListener('click', () => setPlaying(!playing));

// Doubts, with their reason where they are.
const note = byId('note');
const doubtPlace = ({ at: [a, b] }) => place(data, a).add(place(data, b)).multiplyScalar(0.5);
const showNote = (doubt, point) => {
  note.hidden = !doubt;
  if (!doubt) return;
  note.replaceChildren(element('b', { textContent: `${doubt.at[0]} – ${doubt.at[1]}` }), doubt.why);
  const { offsetWidth, offsetHeight, parentElement } = note;
  const x = Math.min(parentElement.clientWidth - offsetWidth - 6, Math.max(6, point.x + 12));
  const y = point.y - offsetHeight - 12 > 6 ? point.y - offsetHeight - 12 : point.y + 12;
  note.style.transform = `translate(${Math.round(x)}px, ${Math.round(Math.min(y, parentElement.clientHeight - offsetHeight - 6))}px)`;
};
const chooseDoubt = (doubt) => {
  chosen = doubt;
  document.querySelectorAll('.doubts button').forEach((button, k) => button.setAttribute('aria-pressed', String(k === doubt)));
  if (!picture) return;
  if (doubt === null) showNote(null);
  else picture.focus(data.doubts[doubt].at.map((row) => place(data, row)));
};
if (picture) {
  picture.listeners.push(() => { if (chosen !== null) showNote(data.doubts[chosen], picture.onScreen(doubtPlace(data.doubts[chosen]))); });
  const stage = byId('stage');
  const HOVER_PIXELS = 12;
  stage.addEventListener('pointermove', (event) => {
    if (event.buttons || chosen !== null || !picture.layers.Doubts.visible) return;
    const { left, top } = stage.getBoundingClientRect();
    const pointer = { x: event.clientX - left, y: event.clientY - top };
    let [nearest, least] = [null, HOVER_PIXELS];
    for (const doubt of data.doubts.slice(0, 2000)) {
      const [a, b] = doubt.at.map((row) => picture.onScreen(place(data, row)));
      const away = toSegment(pointer, a, b);
      if (away < least) [nearest, least] = [doubt, away];
    }
    showNote(nearest, pointer);
  });
  stage.addEventListener('pointerleave', () => { if (chosen === null) showNote(null); });

  // What is shown, and from where.
  for (const [name, layer] of Object.entries(picture.layers)) {
    if (!layer.children.length) continue;
    const box = element('input', { type: 'checkbox', checked: layer.visible });
    box.addEventListener('change', () => { layer.visible = box.checked; picture.request(); });
    byId('layers').append(element('label', {}, box, name));
  }
  const names = picture.arm ? ['Whole', 'Curve'] : ['Whole'];
  for (const name of names) {
    const button = element('button', { type: 'button', textContent: picture.arm ? name : 'Reset view', title: name === 'Whole' ? 'All of it (0)' : 'The poses alone' });
    button.addEventListener('click', () => { chooseDoubt(null); picture.views[name](); });
    byId('views').append(button);
  }
  byId('colouring').addEventListener('change', (event) => picture.colourBy(event.target.value));
  const unit = data.axes[0].includes('/ m') ? ' m' : '';
  const around = data.around ? ` · around ${data.around.map((x) => fixed(x, 3)).join(', ')}${unit}` : '';
  byId('axes').textContent = `${data.axes.map((axis) => axis.split(' ')[0]).join(', ')} · grid ${Number(picture.grid.step.toPrecision(2))}${unit}${around}`;
} else document.querySelector('.tools').hidden = true;

const toSegment = (p, a, b) => {
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  const share = Math.min(1, Math.max(0, ((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(p.x - a.x - share * dx, p.y - a.y - share * dy);
};

// Theme.
const paint = () => {
  byId('theme-label').textContent = isDark() ? 'Light' : 'Dark';
  byId('theme').setAttribute('aria-label', isDark() ? 'Change to light' : 'Change to dark');
  const scale = byId('scale').getContext('2d');
  for (let k = 0; k < 256; k += 1) {
    scale.fillStyle = cssRgb(orderColour(k / 255));
    scale.fillRect(k, 0, 1, 1);
  }
  if (showJointsAt.paint) showJointsAt.paint();
  plots.forEach(({ render }) => render());
  if (picture) picture.paint();
};
const changeTheme = () => {
  document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
  paint();
};
byId('theme').addEventListener('click', changeTheme);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', paint);
byId('scale-from').textContent = 'first';
byId('scale-to').textContent = 'last';

// Keys. Where a control has a use for one itself, it keeps it.
const TURN = 0.12;
addEventListener('keydown', (event) => {
  const { target, key } = event;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const own = target.closest('button, select, [type="radio"], [type="checkbox"], summary');
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key];
  if (arrows && event.shiftKey && picture) picture.view.turn(-TURN * arrows[0], -TURN * arrows[1]);
  else if (arrows && !own?.matches('select, [type="radio"]')) {
    if (arrows[1] && target !== slider) return;
    setTime(time + timeline.step * (arrows[0] - arrows[1]));
  } else if (key === ' ' && !own) setPlaying(!playing);
  else if (key === 'Home' && target === slider) setTime(0);
  else if (key === 'End' && target === slider) setTime(timeline.duration);
  else if ((key === '+' || key === '=') && picture) picture.view.zoom(0.85);
  else if ((key === '-' || key === '−') && picture) picture.view.zoom(1 / 0.85);
  else if (key === '0' && picture && !own?.matches('select')) { chooseDoubt(null); picture.views.Whole(); }
  else if ((key === 't' || key === 'T') && !own?.matches('select')) changeTheme();
  else return;
  event.preventDefault();
});

paint();
setTime(0);

window.report = {
  duration: timeline.duration,
  get time() { return time; },
  get playing() { return playing; },
  get dark() { return isDark(); },
  get framesDrawn() { return picture ? picture.drawn() : 0; },
  setTime,
  setPlaying,
  // base_from_link of every link, sixteen numbers each, column by column.
  linkTransforms: () => Object.fromEntries((picture?.arm?.frames ?? []).map(({ name, group }) => [name, group.matrixWorld.toArray()])),
  // Where a point of the input is on the stage, in pixels.
  onStage: (row) => picture.onScreen(place(data, row)),
  pixel: (x, y) => picture.pixel(x, y),
  drawCalls: () => picture.renderer.info.render.calls,
};
