// The picture: everything that stands still in a handful of draw calls, the arm, and a dot where the motion is.

// Of more poses than this dots are small, lines along the tool are left out in between, and edges are not smoothed: where the processor
// draws, all of it would take half a second a frame.
const MANY = 2000;
const WHISKER_PIXELS = 1;
const WHISKER_SHARE = 0.07;

const buildScene = (data, timeline) => {
  const canvas = byId('stage');
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: data.n <= MANY, powerPreference: 'high-performance' });
  } catch {
    byId('failed').hidden = false;
    byId('failed').textContent = 'This browser draws no WebGL, so that there is no picture; everything else is below.';
    return null;
  }
  const scene = new THREE.Scene();
  let wanted = false;
  let drawn = 0;
  const request = () => {
    if (wanted) return;
    wanted = true;
    requestAnimationFrame(() => { wanted = false; draw(); });
  };
  const view = orbit(canvas, request);

  const places = Array.from({ length: data.n }, (_, row) => place(data, row));
  const curve = ball3(places);
  const scale = Math.max(curve.radius, 1e-9);
  const byOrder = (row) => orderColour(data.shares[row]);
  const byInput = (row) => orderColour(data.n > 1 ? row / (data.n - 1) : 0);
  let colourOf = byOrder;

  const layers = { Poses: new THREE.Group(), Order: new THREE.Group(), Spline: new THREE.Group(), Doubts: new THREE.Group(), Arm: new THREE.Group() };
  Object.values(layers).forEach((layer) => scene.add(layer));
  // Built after colours are known, and coloured anew with the theme.
  const coloured = [];
  const add = (layer, mesh, paint) => { layers[layer].add(mesh); coloured.push({ mesh, paint }); return mesh; };
  const perRow = () => colours(data.n, (row) => colourOf(row));

  add('Poses', dots(data.places, perRow(), data.n > MANY ? 4 : 6, 3), perRow);
  if (data.directions.length) {
    // In the order of the curve, so that those that are left stand evenly.
    const stride = Math.ceil(data.n / MANY);
    const shown = data.order.filter((_, k) => k % stride === 0);
    const ends = new Float32Array(6 * shown.length);
    shown.forEach((row, k) => {
      const from = places[row];
      const to = new THREE.Vector3().fromArray(data.directions, 3 * row).multiplyScalar(WHISKER_SHARE * scale).add(from);
      ends.set([from.x, from.y, from.z, to.x, to.y, to.z], 6 * k);
    });
    const tints = () => colours(shown.length, (k) => colourOf(shown[k]));
    add('Poses', lines(ends, tints(), WHISKER_PIXELS), tints);
  }
  const { from, to } = data.edges;
  const edgeEnds = new Float32Array(6 * from.length);
  from.forEach((row, k) => edgeEnds.set([...places[row].toArray(), ...places[to[k]].toArray()], 6 * k));
  const edgeTints = () => colours(from.length, (k) => byOrder(from[k]));
  add('Order', lines(edgeEnds, edgeTints(), data.spline ? 1 : 2.5, 1), edgeTints);
  if (data.spline) {
    const { places: along, shares } = data.spline;
    const ends = new Float32Array(6 * (shares.length - 1));
    for (let k = 0; k + 1 < shares.length; k += 1) ends.set(along.subarray(3 * k, 3 * k + 6), 6 * k);
    const tints = () => colours(shares.length - 1, (k) => orderColour(shares[k]));
    add('Spline', lines(ends, tints(), 3, 2), tints);
    layers.Order.visible = false;
  }
  if (data.doubts.length) {
    const ends = new Float32Array(6 * data.doubts.length);
    data.doubts.forEach(({ at: [a, b] }, k) => ends.set([...places[a].toArray(), ...places[b].toArray()], 6 * k));
    const tints = () => colours(data.doubts.length, () => styleColour('--doubt'));
    add('Doubts', lines(ends, tints(), 5, 4), tints);
    const rims = () => colours(2 * data.doubts.length, () => styleColour('--doubt'));
    add('Doubts', dots(new Float32Array(ends), rims(), 8, 5), rims);
  }
  const here = add('Poses', dots(new Float32Array(3), colours(1, () => styleColour('--accent')), 13, 6), () => colours(1, () => styleColour('--accent')));
  here.frustumCulled = false;
  here.renderOrder = 3;
  here.material.depthTest = false;

  const arm = data.arm && data.plan ? buildArm(data.arm) : null;
  let whole = curve;
  if (arm) {
    layers.Arm.add(arm.root);
    setJoints(arm, timeline.jointsAt(0));
    const stations = arm.frames.map(({ group }) => new THREE.Vector3().setFromMatrixPosition(group.matrixWorld));
    whole = ball3([new THREE.Vector3(), ...stations, ...places]);
  }
  const light = new THREE.DirectionalLight(0xffffff, 1.6);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x8d8a84, 1.9), light);
  const grid = ground(whole, arm ? 0 : Math.min(...places.map((p) => p.z)));
  scene.add(grid.mesh);

  const seenFrom = () => {
    const normal = new THREE.Vector3(...data.seen_from);
    if (!arm) return normal.z > 0.95 && data.directions.length === 0 ? normal : normal.add(new THREE.Vector3(0.35, -0.6, 0.55));
    // Past the curve towards the arm, from a third of a turn aside.
    const aside = new THREE.Vector3(curve.centre.x, curve.centre.y, 0).normalize().applyAxisAngle(new THREE.Vector3(0, 0, 1), 0.75);
    return aside.add(new THREE.Vector3(0, 0, 0.55));
  };
  const views = {
    Whole: () => view.look(whole.centre, 1.04 * whole.radius, seenFrom()),
    Curve: () => view.look(curve.centre, 1.15 * scale, seenFrom()),
  };

  // The colour that is drawn at a place on the stage, in pixels from its upper left corner.
  const pixel = (x, y) => {
    draw();
    const gl = renderer.getContext();
    const rgba = new Uint8Array(4);
    const ratio = pixelRatio.value;
    gl.readPixels(Math.round(x * ratio), gl.drawingBufferHeight - 1 - Math.round(y * ratio), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
    return Array.from(rgba.subarray(0, 3));
  };
  const draw = () => {
    light.position.copy(view.camera.position).add(new THREE.Vector3(0, 0, whole.radius));
    renderer.render(scene, view.camera);
    drawn += 1;
    listeners.forEach((listener) => listener());
  };
  const listeners = [];
  const resize = () => {
    const { clientWidth, clientHeight } = canvas.parentElement;
    pixelRatio.value = Math.min(2, devicePixelRatio || 1);
    renderer.setPixelRatio(pixelRatio.value);
    renderer.setSize(clientWidth, clientHeight, false);
    viewport.value.set(clientWidth, clientHeight).multiplyScalar(pixelRatio.value);
    view.resize(clientWidth / Math.max(1, clientHeight));
  };
  const paint = () => {
    renderer.setClearColor(new THREE.Color().setRGB(...styleColour('--stage'), THREE.SRGBColorSpace));
    coloured.forEach(({ mesh, paint: tints }) => setTints(mesh, tints()));
    grid.mesh.material.color.setRGB(...styleColour('--grid'), THREE.SRGBColorSpace);
    if (arm) {
      arm.materials.tube.color.setRGB(...styleColour('--arm'), THREE.SRGBColorSpace);
      arm.materials.joint.color.setRGB(...styleColour('--arm-joint'), THREE.SRGBColorSpace);
    }
    request();
  };

  const placed = new THREE.Vector3();
  const set = (time) => {
    if (arm) {
      setJoints(arm, timeline.jointsAt(time));
      placed.setFromMatrixPosition(arm.frames[arm.frames.length - 1].group.matrixWorld);
    } else {
      const at = timeline.placeAt(time);
      const k = Math.min(Math.floor(at), data.n - 1);
      placed.copy(places[data.order[k]]).lerp(places[data.order[Math.min(k + 1, data.n - 1)]], at - k);
      if (data.spline && !data.closed) onSpline(data.spline, at / Math.max(1, data.n - 1), placed);
    }
    here.geometry.attributes.position.set(placed.toArray());
    here.geometry.attributes.position.needsUpdate = true;
    request();
  };
  new ResizeObserver(resize).observe(canvas.parentElement);
  resize();
  views.Whole();
  return {
    view, views, layers, arm, renderer, set, paint, request, listeners, places, grid,
    colourBy: (what) => { colourOf = what === 'input' ? byInput : byOrder; paint(); },
    onScreen: (point) => {
      const flat = point.clone().project(view.camera);
      return { x: (0.5 + 0.5 * flat.x) * canvas.clientWidth, y: (0.5 - 0.5 * flat.y) * canvas.clientHeight, inFront: flat.z < 1 };
    },
    pixel,
    drawn: () => drawn,
    focus: (points) => { const ball = ball3(points); view.look(ball.centre, Math.max(3 * ball.radius, 0.25 * scale)); },
  };
};

// A ball around points: not the smallest, but near it.
const ball3 = (points) => {
  const box = new THREE.Box3().setFromPoints(points);
  const centre = box.getCenter(new THREE.Vector3());
  const radius = Math.sqrt(points.reduce((most, point) => Math.max(most, point.distanceToSquared(centre)), 0));
  return { centre, radius };
};

const onSpline = ({ places, shares }, share, result) => {
  const k = Math.min(lastAtMost(shares, share), shares.length - 2);
  const gap = shares[k + 1] - shares[k];
  const part = gap > 0 ? Math.min(1, (share - shares[k]) / gap) : 0;
  result.fromArray(places, 3 * k).lerp(new THREE.Vector3().fromArray(places, 3 * k + 3), part);
};

// A square grid whose step is a round number of metres.
const ground = ({ centre, radius }, height) => {
  const rough = Math.max(radius, 1e-9) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5].findLast((factor) => factor * power <= rough);
  const half = Math.ceil((1.3 * radius) / step);
  const mesh = new THREE.GridHelper(2 * half * step, 2 * half, 0xffffff, 0xffffff);
  mesh.geometry.deleteAttribute('color');
  mesh.material.vertexColors = false;
  // Behind everything, also behind what lies in its plane.
  mesh.material.depthWrite = false;
  mesh.renderOrder = -1;
  mesh.rotation.x = Math.PI / 2;
  mesh.position.set(Math.round(centre.x / step) * step, Math.round(centre.y / step) * step, height);
  return { mesh, step };
};
