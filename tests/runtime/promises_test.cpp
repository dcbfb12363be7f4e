// SPDX-License-Identifier: GPL-3.0-or-later
// What the force loop is promised: no allocation, the same bits every run, finite bounded forces on any motion.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/runtime/allocation_counter.hpp"
#include "tests/runtime/support.hpp"

namespace palpate {
namespace {

using namespace test;
using runtime::Contact;

Options everything() {
  Options options;
  options.tools = Options::Tools::all;
  options.subdivision = 3;
  options.search = true;
  return options;
}

// A wandering motion round and into the ball: smooth, with jumps and spins now and then.
class Wander {
public:
  explicit Wander(unsigned seed) : random_(seed) {}
  Pose next() {
    std::normal_distribution<double> normal;
    const auto kick = [&](double size) { return size * normal(random_); };
    velocity_ = 0.995 * velocity_ + Vec3{kick(4e-6), kick(4e-6), kick(4e-6)} - 2e-5 * at_;
    at_ = at_ + velocity_;
    turn_ = turn_ + Vec3{kick(2e-3), kick(2e-3), kick(2e-3)};
    if (random_() % 5000 == 0) at_ = Vec3{kick(0.05), kick(0.05), kick(0.05)};
    if (random_() % 7000 == 0) turn_ = Vec3{kick(2), kick(2), kick(2)};
    return Pose::from_quaternion(1, turn_.x, turn_.y, turn_.z, at_);
  }

private:
  std::mt19937 random_;
  Vec3 at_{0, 0, 0.05}, velocity_, turn_;
};

TEST(Promises, OpeningAndTickingAllocateNothing) {
  for (const int coupled : {0, 4}) {
    Options options = everything();
    options.coupled = coupled;
    const Opened ball(ball_content(options));
    Wander wander(31);
    const long before = allocations();
    const runtime::OpenResult opened = runtime::View::open(ball.bytes.data(), ball.bytes.size());
    long touched = 0;
    for (std::uint32_t tool = 0; tool < 3; ++tool) {
      Contact contact(opened.view, tool);
      for (int i = 0; i < 20000; ++i) touched += contact.tick(wander.next()).depth > 0;
    }
    EXPECT_EQ(allocations() - before, 0);
    EXPECT_GT(touched, 1000);
  }
}

TEST(Promises, SameMotionSameBits) {
  const auto run = [] {
    const Opened ball(ball_content(everything()));
    checksum::Xxh64 hash;
    for (std::uint32_t tool = 0; tool < 3; ++tool) {
      Contact contact(ball.view, tool);
      Wander wander(32);
      for (int i = 0; i < 20000; ++i) {
        const Tick tick = contact.tick(wander.next());
        const double values[] = {tick.force.x, tick.force.y, tick.force.z, tick.torque.x, tick.torque.y, tick.torque.z};
        hash.update(values, sizeof values);
      }
    }
    return hash.digest();
  };
  EXPECT_EQ(run(), run());
}

TEST(Promises, RandomMotionsGiveFiniteBoundedForces) {
  for (const int model : {-1, 0, 4}) {  // frictionless, separable, coupled of that order
    const bool friction = model >= 0;
    Options options = everything();
    options.friction = friction;
    options.coupled = std::max(model, 0);
    const Opened ball(ball_content(options));
    for (std::uint32_t tool = 0; tool < 3; ++tool) {
      Contact contact(ball.view, tool);
      Wander wander(33 + tool);
      int held = 0, slid = 0;
      for (int i = 0; i < 100000; ++i) {
        const Pose pose = wander.next();
        const Tick tick = contact.tick(pose);
        const double size = length(tick.force);
        // The curves go on linearly beyond their range: a body of 60 mm bounds them.
        ASSERT_TRUE(std::isfinite(size) && size < 500) << i;
        ASSERT_TRUE(std::isfinite(length(tick.torque)));
        ASSERT_TRUE(size == 0 || tick.depth > 0);
        ASSERT_GE(tick.depth, 0);
        ASSERT_NE(tick.state, State::fault);
        held += tick.state == State::stick;
        slid += tick.state == State::slide;
      }
      EXPECT_GT(slid, 1000);
      if (friction) {
        EXPECT_GT(held, 1000);
      }
    }
  }
}

TEST(Promises, WildPosesGiveFiniteForces) {
  const Opened ball(ball_content(everything()));
  std::mt19937 random(34);
  std::normal_distribution<double> normal;
  for (std::uint32_t tool = 0; tool < 3; ++tool) {
    Contact contact(ball.view, tool);
    for (int i = 0; i < 5000; ++i) {
      const double scale = std::pow(10.0, static_cast<int>(random() % 9) - 4);
      const Vec3 at{scale * normal(random), scale * normal(random), scale * normal(random)};
      const Tick tick =
          contact.tick(Pose::from_quaternion(normal(random), normal(random), normal(random), normal(random), at));
      ASSERT_TRUE(std::isfinite(length(tick.force)) && std::isfinite(length(tick.torque)));
    }
  }
}

}  // namespace
}  // namespace palpate
