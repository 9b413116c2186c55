// The arm: frames from the URDF, links as tubes from joint to joint, joints as short cylinders about their axes.

// Lengths of the picture's parts as shares of the length of the arm.
const THICKEST = 0.042;
const THINNEST = 0.016;

const buildArm = (description) => {
  const lengths = description.links.map((link) => Math.hypot(...link.origin));
  const total = lengths.reduce((sum, length) => sum + length, 0) || 1;
  const materials = { tube: new THREE.MeshLambertMaterial(), joint: new THREE.MeshLambertMaterial() };
  const root = new THREE.Group();
  const frames = [];
  let parent = root;
  let joint = 0;
  description.links.forEach((link) => {
    // The joint's own frame, and in it what moves.
    const mount = new THREE.Group();
    mount.position.fromArray(link.origin);
    mount.quaternion.fromArray(link.quaternion_xyzw);
    const moving = new THREE.Group();
    mount.add(moving);
    parent.add(mount);
    frames.push({ name: link.name, group: moving, axis: link.axis && new THREE.Vector3(...link.axis), slides: link.slides, joint: link.axis ? joint : -1 });
    if (link.axis) joint += 1;
    parent = moving;
  });
  const radius = (k) => total * (THICKEST + (THINNEST - THICKEST) * (k / Math.max(1, frames.length - 1)));
  dress(root, null, description.links[0], radius(0), materials, total);
  frames.forEach((frame, k) => dress(frame.group, frame, description.links[k + 1], radius(k), materials, total));
  frames[frames.length - 1].group.add(triad(0.06 * total));
  return { root, frames, materials };
};

// Draws the body between a frame's joint and the next one's: first along the own axis, then across, as arms are built.
const dress = (group, frame, next, radius, materials, total) => {
  const axis = frame && frame.axis;
  const reach = new THREE.Vector3(...(next ? next.origin : [0, 0, 0]));
  const along = axis ? axis.clone().multiplyScalar(reach.dot(axis)) : new THREE.Vector3();
  if (axis && !frame.slides) {
    const half = axis.clone().multiplyScalar(1.25 * radius);
    group.add(tube(half.clone().negate(), half, 1.2 * radius, materials.joint));
  }
  const short = 1e-3 * total;
  const points = [new THREE.Vector3(), along, reach].filter((point, k, all) => k === 0 || point.distanceTo(all[k - 1]) > short);
  for (let k = 1; k < points.length; k += 1) {
    group.add(tube(points[k - 1], points[k], radius, materials.tube));
    if (k + 1 < points.length) group.add(ball(points[k], radius, materials.tube));
  }
};

const tube = (from, to, radius, material) => {
  const way = to.clone().sub(from);
  const mesh = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, way.length(), 20), material);
  mesh.position.copy(from).addScaledVector(way, 0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way.normalize());
  return mesh;
};

const ball = (at, radius, material) => {
  const mesh = new THREE.Mesh(new THREE.SphereGeometry(radius, 20, 12), material);
  mesh.position.copy(at);
  return mesh;
};

// x, y and z of the tool in red, green and blue, as everywhere in robotics.
const triad = (size) => {
  const ends = new Float32Array(18);
  [0, 1, 2].forEach((k) => { ends[6 * k + 3 + k] = size; });
  return lines(ends, new Float32Array([0.84, 0.2, 0.2, 0.15, 0.6, 0.25, 0.2, 0.4, 0.9]), 2.5);
};

const setJoints = (arm, joints) => {
  arm.frames.forEach(({ group, axis, slides, joint }) => {
    if (!axis) return;
    const { position } = joints[joint];
    if (slides) group.position.copy(axis).multiplyScalar(position);
    else group.quaternion.setFromAxisAngle(axis, position);
  });
  arm.root.updateMatrixWorld(true);
};
