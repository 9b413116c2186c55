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
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
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
    attribute vec3 from, to, fromTint, toTint;
    uniform float width, ratio, nearer;
    uniform vec2 viewport;
    varying vec3 shade;
    void main() {
      shade = mix(fromTint, toTint, position.x);
      vec4 a = projectionMatrix * modelViewMatrix * vec4(from, 1.0);
      vec4 b = projectionMatrix * modelViewMatrix * vec4(to, 1.0);
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

// `ends` has six numbers a segment, `tints` three or six.
const lines = (ends, tints, widthPixels, rank = 0) => {
  const count = ends.length / 6;
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.instanceCount = count;
  const interleaved = (array, stride, names) => {
    const buffer = new THREE.InstancedInterleavedBuffer(array, stride);
    names.forEach((name, k) => geometry.setAttribute(name, new THREE.InterleavedBufferAttribute(buffer, 3, (3 * k) % stride)));
  };
  interleaved(ends, 6, ['from', 'to']);
  interleaved(tints, tints.length / Math.max(count, 1) || 3, ['fromTint', 'toTint']);
  const mesh = new THREE.Mesh(geometry, lineMaterial(widthPixels, rank));
  // Its positions are corners of a rectangle, and say nothing about where it is.
  mesh.frustumCulled = false;
  return mesh;
};

const setTints = (mesh, tints) => {
  const { tint, fromTint } = mesh.geometry.attributes;
  const target = tint || fromTint.data;
  target.array.set(tints);
  target.needsUpdate = true;
};
