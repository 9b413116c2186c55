// Seconds that one exponential and one logarithm of SO(3) and SE(3) take in Pinocchio, over the same thousand elements and in
// the same way as crates/se3-geom/benches/figures.rs.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include <pinocchio/spatial.hpp>

namespace pin = pinocchio;
using Vector = Eigen::Vector3d;

constexpr int COUNT = 1000, PASSES = 50, REPEATS = 100;

// The value must be computed, and may have been changed.
template <class T> void black_box(T &value) { asm volatile("" : : "r"(&value) : "memory"); }

template <class In, class F> void time_each(const char *name, std::vector<In> &inputs, F f, const char *after) {
  double least = INFINITY;
  for (int repeat = 0; repeat < REPEATS; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (int pass = 0; pass < PASSES; ++pass)
      for (auto &input : inputs) {
        black_box(input);
        auto output = f(input);
        black_box(output);
      }
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::printf("\"%s\": %.6g%s", name, least / (PASSES * double(COUNT)), after);
}

// Roberts' R3 sequence in [-1, 1]^3.
Vector even_point(double i) {
  const Vector steps(0.8191725133961645, 0.6710436067037893, 0.5497004779019833);
  return (steps * i).unaryExpr([](double x) { return 2.0 * (x - std::floor(x)) - 1.0; });
}

int main() {
  std::vector<Vector> vectors;
  std::vector<pin::Motion> twists;
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<pin::SE3> poses;
  for (int i = 0; i < COUNT; ++i) {
    vectors.push_back(even_point(i + 0.5).normalized() * (M_PI * i / COUNT));
    twists.emplace_back(even_point(i + 0.25), vectors.back());
    rotations.emplace_back();
    pin::quaternion::exp3(vectors.back(), rotations.back());
    poses.push_back(pin::exp6(twists.back()));
  }
  std::printf("{");
  // A rotation as a quaternion, as ours is; a pose in the form that Pinocchio has for it.
  const auto exp3 = [](const Vector &v) {
    Eigen::Quaterniond q;
    pin::quaternion::exp3(v, q);
    return q;
  };
  time_each("SO(3) exp", vectors, exp3, ", ");
  time_each("SO(3) log", rotations, [](const auto &q) { return Vector(pin::quaternion::log3(q)); }, ", ");
  time_each("SE(3) exp", twists, [](const auto &v) { return pin::exp6(v); }, ", ");
  time_each("SE(3) log", poses, [](const auto &p) { return pin::Motion(pin::log6(p)); }, "}\n");
}
