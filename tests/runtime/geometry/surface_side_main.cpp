// SPDX-License-Identifier: GPL-3.0-or-later
// surface_side POINTS FILE...: the side of the contact surface by closest_point() against the winding number, at random
// points 0.01 to 5 mm off random points of the surface, as a table in Markdown. Exit code 5: a point has another side.
#include <palpate/format/mapped_file.hpp>
#include <palpate/palpate.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace palpate::test {
namespace {

using runtime::dot;
using runtime::Vec3;
using runtime::View;

constexpr std::array kOffsets{1e-5, 1e-4, 1e-3, 5e-3};  // m, standard deviations of a coordinate

struct Sides {
  int wrong = 0, not_whole = 0, inside = 0;
  double farthest_wrong = 0;  // m
};

double winding_number(const View& view, const Vec3& p) {
  double sum = 0;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    const auto& corner = view.triangle(t).vertex;
    const Vec3 a = runtime::vertex(view, corner[0]) - p, b = runtime::vertex(view, corner[1]) - p,
               c = runtime::vertex(view, corner[2]) - p;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

Sides sides(const View& view, int points) {
  std::mt19937 random(1);
  std::vector<double> areas;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) areas.push_back(length(runtime::face_normal(view, t)));
  std::discrete_distribution<std::uint32_t> triangle(areas.begin(), areas.end());
  std::uniform_real_distribution<> uniform;
  std::normal_distribution<> normal;
  Sides result;
  for (int k = 0; k < points; ++k) {
    double a = uniform(random), b = uniform(random);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const double offset = kOffsets[static_cast<std::size_t>(k) % kOffsets.size()];
    const Vec3 away{normal(random), normal(random), normal(random)};
    const Vec3 p = runtime::position(view, {triangle(random), {a, b, 1 - a - b}}) + offset * away;
    const double distance = runtime::closest_point(view, p).signed_distance, winding = winding_number(view, p);
    const long whole = std::lround(winding);
    if (std::fabs(winding - static_cast<double>(whole)) > 1e-3) ++result.not_whole;
    if (whole != 0) ++result.inside;
    if ((distance < 0) == (whole == 1) && (whole == 0 || whole == 1)) continue;
    ++result.wrong;
    result.farthest_wrong = std::max(result.farthest_wrong, std::fabs(distance));
  }
  return result;
}

// True where every point has the same side by both.
bool print_row(const char* file, int points) {
  const runtime::MappedFile mapped(file);
  const runtime::OpenResult opened = View::open(mapped.data(), mapped.size());
  if (!opened) {
    std::fprintf(stderr, "%s: %s\n", file, opened.error);
    return false;
  }
  const Sides s = sides(opened.view, points);
  std::printf("| %s | %u | %zu | %d | %d | %d | %d | %.2g |\n", std::filesystem::path(file).stem().c_str(),
              opened.view.meta->triangle_count, mapped.size(), points, s.inside, s.not_whole, s.wrong,
              1e3 * s.farthest_wrong);
  std::fflush(stdout);
  return s.wrong == 0 && s.not_whole == 0;
}

}  // namespace
}  // namespace palpate::test

int main(int count, char** arguments) {
  const int points = count > 2 ? std::atoi(arguments[1]) : 0;
  if (points < 1) {
    std::fprintf(stderr, "usage: surface_side POINTS FILE...\n");
    return 1;
  }
  std::puts("| file | triangles | bytes | points | inside | winding number not whole | other side | farthest (mm) |");
  std::puts("| --- | --- | --- | --- | --- | --- | --- | --- |");
  bool same = true;
  for (int k = 2; k < count; ++k) same = palpate::test::print_row(arguments[k], points) && same;
  return same ? 0 : 5;
}
