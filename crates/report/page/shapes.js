// Dots and lines of constant width in pixels, each kind in one draw call however many there are.

const colours = (count, colourOf) => {
  const values = new Float32Array(3 * count);
  for (let i = 0; i < count; i += 1) values.set(colourOf(i), 3 * i);
  return values;
};

// Shared by all of them; the scene keeps it up to date.
const viewport = { value: new THREE.Vector2(1, 1) };
const pixelRatio = { value: 1 };

// What lies in one place is seen by its `rank`, the higher in front.
const RANK_DEPTH = 2e-5;

const dotMaterial = (sizePixels, rank) => new THREE.ShaderMaterial({
  uniforms: { size: { value: sizePixels }, ratio: pixelRatio, nearer: { value: rank * RANK_DEPTH } },
  vertexShader: `
    attribute vec3 tint;
    uniform float size, ratio, nearer;
    varying vec3 shade;
    void main() {
      shade = tint;
      gl_Position = projectionMatrix * (modelViewMatrix * vec4(position, 1.0));
      gl_Position.z -= nearer * gl_Position.w;
      gl_PointSize = size * ratio;
    }`,
  fragmentShader: `
    varying vec3 shade;
    void main() {
      vec2 offset = 2.0 * gl_PointCoord - 1.0;
      if (dot(offset, offset) > 1.0) discard;
      gl_FragColor = vec4(shade, 1.0);
    }`,
});

const dots = (places, tints, sizePixels, rank) => {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
  geometry.setAttribute('tint', new THREE.BufferAttribute(tints, 3));
  return new THREE.Points(geometry, dotMaterial(sizePixels, rank));
};

// Segments as rectangles that face the eye. An end behind the eye is moved to just before it.
const lineMaterial = (widthPixels, rank) => new THREE.ShaderMaterial({
  uniforms: { width: { value: widthPixels }, ratio: pixelRatio, viewport, nearer: { value: rank * RANK_DEPTH } },
  side: THREE.DoubleSide,
  vertexShader: `
    attribute vec3 from, to, tint;
    uniform float width, ratio, nearer;
    uniform vec2 viewport;
    varying vec3 shade;
    void main() {
      shade = tint;
      vec4 a = projectionMatrix * (modelViewMatrix * vec4(from, 1.0));
      vec4 b = projectionMatrix * (modelViewMatrix * vec4(to, 1.0));
      const float near = 1e-4;
      if (a.w < near && b.w > near) a = mix(a, b, (near - a.w) / (b.w - a.w));
      if (b.w < near && a.w > near) b = mix(b, a, (near - b.w) / (a.w - b.w));
      vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
      along = dot(along, along) > 1e-12 ? normalize(along) : vec2(1.0, 0.0);
      vec2 across = vec2(-along.y, along.x);
      vec4 here = mix(a, b, position.x);
      vec2 offset = (across * position.y + along * (position.x - 0.5) * 0.6) * width * ratio;
      here.xy += offset / viewport * here.w;
      here.z -= nearer * here.w;
      gl_Position = here;
    }`,
  fragmentShader: `
    varying vec3 shade;
    void main() { gl_FragColor = vec4(shade, 1.0); }`,
});

// `ends` has six numbers a segment, `tints` three, or six for one at each end. Corners are written out rather than instanced: with four
// of them an instance costs more than what it draws, a hundred times more where the processor draws.
const CORNERS = [[0, -1], [1, -1], [1, 1], [0, 1]];

const lines = (ends, tints, widthPixels, rank = 0) => {
  const count = ends.length / 6;
  const [corners, from, to] = [0, 0, 0].map(() => new Float32Array(12 * count));
  const index = new Uint32Array(6 * count);
  for (let k = 0; k < count; k += 1) {
    CORNERS.forEach((corner, c) => {
      const at = 12 * k + 3 * c;
      corners.set(corner, at);
      from.set(ends.subarray(6 * k, 6 * k + 3), at);
      to.set(ends.subarray(6 * k + 3, 6 * k + 6), at);
    });
    index.set([0, 1, 2, 0, 2, 3].map((c) => 4 * k + c), 6 * k);
  }
  const geometry = new THREE.BufferGeometry();
  for (const [name, values] of Object.entries({ position: corners, from, to, tint: atCorners(tints, count) })) {
    geometry.setAttribute(name, new THREE.BufferAttribute(values, 3));
  }
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  const mesh = new THREE.Mesh(geometry, lineMaterial(widthPixels, rank));
  // Its positions are corners of a rectangle, and say nothing about where it is.
  mesh.frustumCulled = false;
  return mesh;
};

const atCorners = (tints, count) => {
  const stride = count ? tints.length / count : 3;
  const values = new Float32Array(12 * count);
  for (let k = 0; k < count; k += 1) {
    CORNERS.forEach(([end], c) => {
      const at = stride * k + (stride === 6 ? 3 * end : 0);
      values.set(tints.subarray(at, at + 3), 12 * k + 3 * c);
    });
  }
  return values;
};

const setTints = ({ geometry, isMesh }, tints) => {
  const { tint, from } = geometry.attributes;
  tint.array.set(isMesh ? atCorners(tints, from.count / 4) : tints);
  tint.needsUpdate = true;
};
