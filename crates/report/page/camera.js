// A camera that goes round a point, z upwards: by pointer, wheel, fingers and keys.

const OPENING_DEGREES = 32;

const orbit = (canvas, changed) => {
  const camera = new THREE.PerspectiveCamera(OPENING_DEGREES, 1, 0.01, 100);
  camera.up.set(0, 0, 1);
  const target = new THREE.Vector3();
  let [azimuth, polar, distance] = [0, 1, 1];
  let flight = 0;

  const apply = () => {
    polar = Math.min(Math.PI - 0.01, Math.max(0.01, polar));
    const flat = Math.sin(polar);
    camera.position.set(flat * Math.cos(azimuth), flat * Math.sin(azimuth), Math.cos(polar)).multiplyScalar(distance).add(target);
    camera.near = distance / 200;
    camera.far = distance * 50;
    camera.lookAt(target);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
    changed();
  };
  const turn = (dx, dy) => { azimuth -= dx; polar -= dy; apply(); };
  const zoom = (factor) => { distance = Math.min(1e4, Math.max(1e-4, distance * factor)); apply(); };
  const move = (dx, dy) => {
    const perPixel = (2 * distance * Math.tan((OPENING_DEGREES * Math.PI) / 360)) / canvas.clientHeight;
    const right = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
    const up = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
    target.addScaledVector(right, -dx * perPixel).addScaledVector(up, dy * perPixel);
    apply();
  };
  // Sees a ball of this radius whole; from `direction`, where one is given.
  const look = (centre, radius, direction) => {
    const opening = (OPENING_DEGREES * Math.PI) / 360;
    const narrow = Math.atan(Math.tan(opening) * Math.min(1, camera.aspect));
    const goal = { target: centre.clone(), distance: Math.max(radius, 1e-6) / Math.sin(narrow), azimuth, polar };
    if (direction) {
      const unit = direction.clone().normalize();
      goal.polar = Math.acos(Math.min(1, Math.max(-1, unit.z)));
      // From straight above, x is to the right.
      goal.azimuth = Math.hypot(unit.x, unit.y) > 0.02 ? Math.atan2(unit.y, unit.x) : -Math.PI / 2;
    }
    fly(goal);
  };
  const fly = (goal) => {
    cancelAnimationFrame(flight);
    const from = { target: target.clone(), distance, azimuth, polar };
    const wholeTurn = Math.round((goal.azimuth - from.azimuth) / (2 * Math.PI)) * 2 * Math.PI;
    const begun = performance.now();
    const milliseconds = matchMedia('(prefers-reduced-motion: reduce)').matches || !look.arrived ? 0 : 280;
    look.arrived = true;
    const step = (now) => {
      const share = milliseconds ? Math.min(1, Math.max(0, (now - begun) / milliseconds)) : 1;
      const eased = share * share * (3 - 2 * share);
      const mixed = (a, b) => a + (b - a) * eased;
      target.lerpVectors(from.target, goal.target, eased);
      distance = from.distance * (goal.distance / from.distance) ** eased;
      azimuth = mixed(from.azimuth, goal.azimuth - wholeTurn);
      polar = mixed(from.polar, goal.polar);
      apply();
      if (share < 1) flight = requestAnimationFrame(step);
    };
    step(begun);
  };

  const fingers = new Map();
  canvas.addEventListener('pointerdown', (event) => {
    cancelAnimationFrame(flight);
    fingers.set(event.pointerId, event);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
    if (fingers.size === 2) {
      const [other] = [...fingers.values()].filter((finger) => finger.pointerId !== event.pointerId);
      const apart = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
      zoom(apart(before) / Math.max(1, apart(event)));
      move(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) move(dx, dy);
    else turn((5 * dx) / canvas.clientHeight, (5 * dy) / canvas.clientHeight);
    fingers.set(event.pointerId, event);
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(Math.sign(event.deltaY) * Math.min(0.3, Math.abs(event.deltaY) / 500)));
  }, { passive: false });
  return { camera, target, turn, zoom, look, resize: (aspect) => { camera.aspect = aspect; apply(); } };
};
