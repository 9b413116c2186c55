// Colours: those of the style sheet, and two scales that are even to the eye (equal steps in OKLab, Ottosson 2020).

const oklch = (lightness, chroma, hueDegrees) => {
  const hue = (hueDegrees * Math.PI) / 180;
  const [a, b] = [chroma * Math.cos(hue), chroma * Math.sin(hue)];
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((x) => {
    const encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
    return Math.min(1, Math.max(0, encoded || 0));
  });
};
const cssRgb = (rgb) => `rgb(${rgb.map((x) => Math.round(255 * x)).join(' ')})`;

const isDark = () => {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
};

// From violet over teal to leaf green: lightness and hue grow at constant rates, so that steps look alike, and it reads in grey too. It
// keeps away from red, which means doubt.
const orderColour = (share) => {
  const [darkest, lightest] = isDark() ? [0.5, 0.88] : [0.36, 0.74];
  return oklch(darkest + (lightest - darkest) * share, 0.125, 300 - 175 * share);
};

// One for each joint, of equal lightness, away from the red of doubts.
const JOINT_HUES = [255, 60, 150, 330, 200, 290, 105];
const jointColour = (joint) => oklch(isDark() ? 0.76 : 0.57, 0.125, JOINT_HUES[joint % JOINT_HUES.length]);

// A colour of the style sheet as three numbers from 0 to 1.
const styleColour = (name) => {
  const probe = byId('name');
  const before = probe.style.color;
  probe.style.color = `var(${name})`;
  const parts = getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3).map(Number);
  probe.style.color = before;
  return parts.map((x) => x / 255);
};
