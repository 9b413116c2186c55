// What the slider runs along: the seconds of a plan, or without one the poses in their order.

const lastAtMost = (sorted, value) => {
  let [low, high] = [0, sorted.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (sorted[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
};

// The quintic with position, velocity and acceleration at both ends, as a ROS trajectory controller has it.
const quintic = (h, u, from, to) => {
  const [p0, v0, a0] = [from[0], from[1] * h, from[2] * h * h];
  const [p1, v1, a1] = [to[0], to[1] * h, to[2] * h * h];
  const d = p1 - p0;
  const c3 = 10 * d - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1;
  const c4 = -15 * d + 8 * v0 + 7 * v1 + 1.5 * a0 - a1;
  const c5 = 6 * d - 3 * v0 - 3 * v1 - 0.5 * a0 + 0.5 * a1;
  return p0 + u * (v0 + u * (0.5 * a0 + u * (c3 + u * (c4 + u * c5))));
};

const planTimeline = (data) => {
  const { motion, poseTimes } = data.plan;
  const { times } = motion;
  const dof = motion.joints.length;
  // The rows of the order by the time at which they are passed, for finding the one that was passed last.
  const passed = Array.from(data.order).sort((a, b) => poseTimes[a] - poseTimes[b]);
  const passedTimes = passed.map((row) => poseTimes[row]);

  const jointsAt = (time) => {
    const t = Math.min(Math.max(time, times[0]), times[times.length - 1]);
    const row = Math.min(lastAtMost(times, t), Math.max(0, times.length - 2));
    const next = Math.min(row + 1, times.length - 1);
    const h = times[next] - times[row];
    const u = h > 0 ? (t - times[row]) / h : 0;
    const mixed = (values, joint) => values[row * dof + joint] * (1 - u) + values[next * dof + joint] * u;
    const state = (at, joint) => [motion.positions[at * dof + joint], motion.velocities[at * dof + joint], motion.accelerations[at * dof + joint]];
    return motion.joints.map((_, joint) => ({
      position: h > 0 ? quintic(h, u, state(row, joint), state(next, joint)) : motion.positions[row * dof + joint],
      velocity: mixed(motion.velocities, joint),
      acceleration: mixed(motion.accelerations, joint),
      jerk: h > 0 ? motion.jerks[(row * dof + joint) * 3 + (u < 1 / 3 ? 0 : u < 2 / 3 ? 1 : 2)] : 0,
    }));
  };
  return {
    unit: 's',
    duration: times[times.length - 1],
    perSecond: 1,
    step: 0.1,
    jointsAt,
    // How far along the order, in poses.
    placeAt: (time) => {
      if (passed.length < 2 || time <= passedTimes[0]) return 0;
      const k = lastAtMost(passedTimes, time);
      if (k + 1 >= passed.length) return data.n - 1;
      const gap = passedTimes[k + 1] - passedTimes[k];
      return k + (gap > 0 ? (time - passedTimes[k]) / gap : 0);
    },
    timeOf: (row) => poseTimes[row],
  };
};

const orderTimeline = (data) => {
  const rank = new Uint32Array(data.n);
  data.order.forEach((row, k) => { rank[row] = k; });
  return {
    unit: 'poses',
    duration: Math.max(data.n - 1, 1e-9),
    // The whole order in ten seconds, as no clock says how fast.
    perSecond: Math.max(data.n - 1, 1) / 10,
    step: 1,
    jointsAt: null,
    placeAt: (time) => time,
    timeOf: (row) => rank[row],
  };
};

const timelineOf = (data) => (data.plan ? planTimeline(data) : orderTimeline(data));
