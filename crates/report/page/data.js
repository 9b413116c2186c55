// What the page shows, as it was packed.

const unpacked = (text, Kind) => {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; i += 1) bytes[i] = characters.charCodeAt(i);
  return new Kind(bytes.buffer);
};
const single = (text) => unpacked(text, Float32Array);
const double = (text) => unpacked(text, Float64Array);
const index = (text) => unpacked(text, Uint32Array);

const readData = () => {
  const data = JSON.parse(document.getElementById('data').textContent);
  data.places = single(data.places);
  data.directions = single(data.directions);
  data.order = index(data.order);
  data.edges = { from: index(data.edges.from), to: index(data.edges.to), epsilons: single(data.edges.epsilons) };
  if (data.spline) data.spline = { places: single(data.spline.places), shares: single(data.spline.shares) };
  if (data.plan) {
    const { motion } = data.plan;
    motion.times = double(motion.times_s);
    for (const what of ['positions', 'velocities', 'accelerations', 'jerks']) motion[what] = single(motion[what]);
    data.plan.poseTimes = double(data.plan.pose_times_s);
  }
  if (data.simulation) {
    data.simulation.times = double(data.simulation.times_s);
    data.simulation.errors = single(data.simulation.errors);
  }
  // Where each row stands in the order, from 0 to 1.
  data.n = data.order.length;
  data.shares = new Float32Array(data.n);
  data.order.forEach((row, k) => { data.shares[row] = data.n > 1 ? k / (data.n - 1) : 0; });
  return data;
};

const place = (data, row) => new THREE.Vector3().fromArray(data.places, 3 * row);

// A number for people: four digits that count.
const figure = (value, digits = 4) => {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(2).replace('-', '−').replace('e−', 'e−').replace('e+', 'e');
  const decimals = size === 0 ? 0 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(decimals).replace('-', '−');
};
const fixed = (value, decimals) => (Number.isFinite(value) ? value.toFixed(decimals).replace(/^-(?=0\.?0*$)/, '').replace('-', '−') : '–');

const element = (name, attributes = {}, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key in made && key !== 'list') made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
};
const svg = (name, attributes = {}, ...children) => {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
};
const byId = (id) => document.getElementById(id);
