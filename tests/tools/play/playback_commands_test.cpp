// SPDX-License-Identifier: GPL-3.0-or-later
// palpate play, inspect and bench as commands: results, JSON, exit codes of what goes wrong.
#include <sys/stat.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/palpate_program.hpp"
#include "tests/runtime/two_lobes.hpp"
#include "tests/support/response_samples.hpp"

namespace palpate::test {
namespace {

using Json = nlohmann::json;

class Playback : public PalpateProgram {
protected:
  void SetUp() override {
    ResponseSampleOptions options;
    options.tools = ResponseSampleOptions::Tools::all;
    write_response_file(folder() / "box.palp", encode(box_content(options)));
    std::string motion = "t,x,y,z,qw,qx,qy,qz\n";
    for (int i = 0; i <= 40; ++i) {
      const double depth = i <= 20 ? -0.002 + 0.00025 * i : 0.003 - 0.00025 * (i - 20);
      motion += std::to_string(0.01 * i) + ",0,0," + std::to_string(kBoxSize / 4 + kTipRadius - depth) + ",1,0,0,0\n";
    }
    write("push.csv", motion);
  }
};

TEST_F(Playback, PlayWritesForcesAndPlotAndTellsThePeak) {
  const RunResult result = run({"play", "box.palp", "push.csv", "--out", "f.csv", "--plot", "f.svg", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["tool"], "ball");
  EXPECT_EQ(json["rows"], 41);
  EXPECT_EQ(json["contacts"], 1);
  EXPECT_NEAR(json["peak_depth"].get<double>(), 0.003, 1e-5);
  EXPECT_GT(json["peak_force"].get<double>(), 0.5);
  EXPECT_EQ(file_content(folder() / "f.csv").rfind("t,fx,fy,fz", 0), 0U);
  EXPECT_NE(file_content(folder() / "f.svg").find("force (N)"), std::string::npos);
}

TEST_F(Playback, FramesShowTheDentOfAFileWithCompliance) {
  expect_failure(run({"play", "box.palp", "push.csv", "--frames", "none"}), 2, {"--frames", "no compliance"});
  ResponseSampleOptions options;
  options.modes = 8;
  write_response_file(folder() / "compliant.palp", encode(box_content(options)));
  // An earlier, longer motion left these.
  std::filesystem::create_directory(folder() / "frames");
  for (const char* earlier : {"frame-00013.glb", "frame-00014.glb", "notes.txt"}) {
    write("frames/" + std::string(earlier), "x");
  }
  const RunResult result = run({"play", "compliant.palp", "push.csv", "--frames", "frames"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  // 0.4 s at 30 frames a second, the first included.
  EXPECT_TRUE(std::filesystem::exists(folder() / "frames" / "frame-00012.glb"));
  for (const char* earlier : {"frame-00013.glb", "frame-00014.glb"}) {
    EXPECT_FALSE(std::filesystem::exists(folder() / "frames" / earlier)) << earlier;
  }
  EXPECT_TRUE(std::filesystem::exists(folder() / "frames" / "notes.txt"));
  const std::string first = file_content(folder() / "frames" / "frame-00000.glb"),
                    pressed = file_content(folder() / "frames" / "frame-00006.glb");
  EXPECT_EQ(first.substr(0, 4), "glTF");
  EXPECT_GT(first.size(), 100000U);
  EXPECT_NE(first, pressed);
}

TEST_F(Playback, OneContactIsOneContact) {
  const RunResult result = run({"play", "box.palp", "push.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_NE(result.out.find(" 1 contact;"), std::string::npos) << result.out;
}

TEST_F(Playback, CompareTellsWhereAnOrganIsStiffer) {
  ResponseSampleOptions options;
  options.uniform = true;
  ResponseFileContent content = ball_content(options);
  write_response_file(folder() / "even.palp", encode(content));
  for (Response& r : content.responses) r.unit *= 1.25F;
  content.responses[4].unit *= 1.2F;  // the site on top
  write_response_file(folder() / "stiff.palp", encode(content));
  const Json json = Json::parse(run({"compare", "stiff.palp", "even.palp", "--json"}).out);
  EXPECT_EQ(json["sites"], content.sites.size());
  EXPECT_NEAR(json["median"]["ratio"].get<double>(), 1.25, 0.01);
  EXPECT_NEAR(json["largest"]["ratio"].get<double>(), 1.5, 0.01);
  EXPECT_NEAR(json["largest"]["position_m"][2].get<double>(), kBallRadius, 1e-6);
  const Json shallow = Json::parse(run({"compare", "stiff.palp", "even.palp", "--depth", "1e-4", "--json"}).out);
  EXPECT_NEAR(shallow["largest"]["depth_m"].get<double>(), 1e-4, 1e-12);
  ResponseSampleOptions odd;
  odd.cells = 5;  // no site in the middle of a face, where the ball has one
  write_response_file(folder() / "odd.palp", encode(box_content(odd)));
  const RunResult far = run({"compare", "stiff.palp", "odd.palp", "--within", "1e-9"});
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_NE(far.error.find("a larger --within"), std::string::npos) << far.error;
}

TEST_F(Playback, InspectTellsNoMoreThanTheFileDoes) {
  ResponseSampleOptions options;
  options.friction = false;  // the tangential bias stays
  write_response_file(folder() / "smooth.palp", encode(box_content(options)));
  const RunResult smooth = run({"inspect", "smooth.palp"});
  EXPECT_NE(smooth.out.find("tangential_bias  present"), std::string::npos) << smooth.out;
  EXPECT_EQ(smooth.out.find("no tangential force"), std::string::npos) << smooth.out;
  EXPECT_EQ(smooth.out.find("is small"), std::string::npos) << "why there is no search is not in the file";
  const RunResult all = run({"inspect", "box.palp"});
  for (const char* tool : {"tool 'ball': sphere", "tool 'rod': capsule", "tool 'gem': mesh"}) {
    EXPECT_NE(all.out.find(tool), std::string::npos) << all.out;
  }
  EXPECT_EQ(Json::parse(run({"inspect", "box.palp", "--json"}).out)["tools"][1]["kind"], "capsule");
}

// A tip pressed between two balls: one wall alone pushes it to the side, both push it straight up.
TEST_F(Playback, PlayFeelsBothWallsAndCountsTheWallThatSingleLeavesOut) {
  write_response_file(folder() / "lobes.palp", encode(two_lobes(smooth(false))));
  std::string motion = "t,x,y,z,qw,qx,qy,qz\n";
  for (int i = 0; i <= 40; ++i) {
    motion += std::to_string(0.01 * i) + ",0,0," + std::to_string(between() + 0.001 - 1e-4 * i) + ",1,0,0,0\n";
  }
  write("between.csv", motion);
  const RunResult one = run({"play", "lobes.palp", "between.csv", "--single", "--out", "one.csv"});
  ASSERT_EQ(one.exit_code, 0) << one.error;
  EXPECT_NE(one.error.find(" of 41 rows the tool overlaps another wall, which --single leaves out"), std::string::npos)
      << one.error;
  const RunResult both = run({"play", "lobes.palp", "between.csv", "--out", "both.csv", "--json"});
  ASSERT_EQ(both.exit_code, 0) << both.error;
  EXPECT_EQ(both.error.find("another wall"), std::string::npos) << both.error;
  EXPECT_EQ(Json::parse(both.out)["rows_other_contacts"], 0);
  // The last row of each: t,fx,fy,fz and so on.
  const auto last = [&](const char* name) {
    const std::string text = file_content(folder() / name);
    std::istringstream row(text.substr(text.rfind('\n', text.size() - 2) + 1));
    std::array<double, 4> values{};
    char comma = 0;
    for (double& value : values) row >> value >> comma;
    return values;
  };
  EXPECT_GT(std::abs(last("one.csv")[1]), 0.5 * last("one.csv")[3]);
  EXPECT_LT(std::abs(last("both.csv")[1]), 0.1 * last("both.csv")[3]);
  EXPECT_GT(last("both.csv")[3], 1.7 * last("one.csv")[3]);
  EXPECT_EQ(run({"play", "box.palp", "push.csv", "--single"}).error.find("another wall"), std::string::npos);
}

TEST_F(Playback, PlayTakesTheToolAskedFor) {
  const RunResult result = run({"play", "box.palp", "push.csv", "--tool", "rod", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  EXPECT_EQ(Json::parse(result.out)["tool"], "rod");
}

TEST_F(Playback, InspectListsSectionsFeaturesAndProvenance) {
  const RunResult result = run({"inspect", "box.palp", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["features"], Json({"tangential_bias", "friction", "tool_patches"}));
  EXPECT_EQ(json["left_out"], (Json{"slip_softening", "bonded", "bonded_torque", "spin", "compliance", "search"}));
  EXPECT_EQ(json["provenance"]["generator"], "test");
  EXPECT_EQ(json["responses"].get<int>(), json["responses_solved"].get<int>() + json["responses_filled"].get<int>());
  EXPECT_EQ(json["tools"].size(), 3U);
  std::size_t bytes = 0;
  for (const Json& section : json["sections"]) bytes += section["bytes"].get<std::size_t>();
  EXPECT_LT(bytes, json["bytes"].get<std::size_t>());
  const RunResult text = run({"inspect", "box.palp"});
  EXPECT_EQ(text.out.find(" 1 contact vertices"), std::string::npos) << text.out;
  for (const char* part :
       {"1 contact vertex\n", "RESPONSES", "left out", "tool 'gem': mesh", "\"generator\": \"test\""}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part;
  }
}

TEST_F(Playback, BenchNamesTheMachineAndTimesEveryState) {
  if (listed_commands().count("bench") == 0) GTEST_SKIP() << "built without Google Benchmark";
  const RunResult result = run(
      {"bench", "box.palp", "--json", "--contacts", "3", "--seconds", "0.002", "--ticks", "6921", "--sites", "1e4"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json json = Json::parse(result.out);
  EXPECT_FALSE(json["machine"].get<std::string>().empty());
  // 12 bytes, 28 coefficients of F, g, K' and A, 3 of mu, 2 bytes each, filled up to a multiple of 4.
  EXPECT_EQ(json["bytes_per_response"].get<double>(), 76);
  for (const char* state : {"press", "field", "slide", "free"}) {
    EXPECT_GT(json["tick_ns"][state]["median"].get<double>(), 1) << state;
    EXPECT_LT(json["tick_ns"][state]["median"].get<double>(), 1e6) << state;
    EXPECT_GE(json["tick_ns"][state]["mean"], json["tick_ns"][state]["median"]) << state;
  }
  for (const char* part :
       {"locate_ns", "blend_ns", "anew_ns", "random_ns", "five_ns", "joint_ns", "plain_ns", "network_ns", "every_ns"}) {
    EXPECT_GT(json[part]["median"].get<double>(), 1) << part;
    EXPECT_GE(json[part]["worst"], json[part]["median"]) << part;
  }
  EXPECT_GE(json["random_among_responses"], 1e4);
  const Json &every = json["every_ns"], &undisturbed = every["undisturbed"];
  EXPECT_EQ(every["ticks"], 6921);  // three times the strokes of three contacts
  EXPECT_EQ(undisturbed["ticks"], 2307);
  EXPECT_GT(undisturbed["median"].get<double>(), 1);
  for (const char* share : {"median", "p99.9", "worst"}) EXPECT_LE(undisturbed[share], every[share]) << share;
}

TEST_F(Playback, BenchOpensTheFileAndALargerOneOfTheSameBody) {
  if (listed_commands().count("bench") == 0) GTEST_SKIP() << "built without Google Benchmark";
  ResponseSampleOptions options;
  options.search = true;  // whose tree is grown over all copies, and read by the validation that is timed
  options.tools = ResponseSampleOptions::Tools::all;
  write_response_file(folder() / "search.palp", encode(box_content(options)));
  options.bits = 8;
  write_response_file(folder() / "packed.palp", encode(box_content(options)));
  for (const char* file : {"box.palp", "search.palp", "packed.palp"}) {
    const Json once = Json::parse(run({"bench", file, "--open", "--json"}).out);
    EXPECT_EQ(once["bytes"], std::filesystem::file_size(folder() / file));
    const RunResult result = run({"bench", file, "--open", "--bytes", "3e6", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const Json many = Json::parse(result.out);
    EXPECT_GE(many["bytes"], 3000000);
    EXPECT_LT(many["bytes"], 4000000);
    EXPECT_GT(many["responses"], 5 * once["responses"].get<int>());
    EXPECT_EQ(many["responses"].get<int>() % once["responses"].get<int>(), 0);
    const Json wide = Json::parse(run({"bench", file, "--open", "--sites", "1e3", "--json"}).out);
    EXPECT_GE(wide["sites"], 1000);
    EXPECT_LT(wide["sites"].get<int>(), 1000 + once["sites"].get<int>());
    std::uint64_t parts = 0;
    for (const Json& part : wide["parts"]) parts += part["bytes"].get<std::uint64_t>();
    EXPECT_GT(parts, wide["bytes"].get<std::uint64_t>() - 4096);
    for (const Json& times : {once, many}) {
      EXPECT_GT(times["open_trusted_s"]["median"], 0);
      EXPECT_GT(times["open_s"]["median"], times["open_trusted_s"]["median"]);
      EXPECT_GE(times["open_s"]["worst"], times["open_s"]["median"]);
    }
  }
}

TEST_F(Playback, BadInputsEndWithTheirCodeAndCause) {
  write("empty.palp", "");
  write("text.palp", std::string(5000, 'x'));
  std::string damaged = file_content(folder() / "box.palp");
  damaged[damaged.size() / 2] ^= 1;
  write("damaged.palp", damaged);
  write("short.palp", damaged.substr(0, 3000));
  write("bad.csv", "t,x,y,z,qw,qx,qy,qz\n0,0,0,0,2,0,0,0\n");
  ASSERT_EQ(::mkfifo((folder() / "pipe").c_str(), 0600), 0);  // that nobody writes to
  struct Case {
    std::vector<std::string> arguments;
    int code;
    std::vector<std::string> cause;
  };
  const Case cases[] = {
      {{"inspect", "none.palp"}, 4, {"none.palp", "No such file"}},
      {{"inspect", "empty.palp"}, 2, {"empty.palp", "truncated"}},
      {{"inspect", "text.palp"}, 2, {"text.palp", "not a Palpate response file"}},
      {{"inspect", "damaged.palp"}, 2, {"damaged.palp", "checksum"}},
      {{"inspect", "short.palp"}, 2, {"short.palp", "truncated"}},
      {{"inspect", "."}, 4, {"not a regular file"}},
      {{"play", "box.palp", "none.csv"}, 4, {"none.csv", "No such file"}},
      {{"play", "box.palp", "bad.csv"}, 2, {"bad.csv:2", "quaternion"}},
      {{"play", "box.palp", "push.csv", "--tool", "knife"}, 2, {"no tool 'knife'", "ball, rod, gem"}},
      {{"play", "box.palp", "push.csv", "--out", "none/f.csv"}, 4, {"none/f.csv"}},
      {{"play", "box.palp"}, 1, {"motion"}},
      {{"play", "box.palp", "pipe"}, 4, {"pipe", "not a regular file"}},
      {{"play", "pipe"}, 1, {"motion is required"}},
      {{"export", "box.palp", "--curves", "c.csv", "--tool", "knife"}, 2, {"no tool 'knife'"}},
      {{"bench", "box.palp", "--open", "--tool", "knife"}, 2, {"no tool 'knife'"}},
      {{"bench", "none.palp", "--open"}, 4, {"none.palp", "No such file"}},
      {{"bench", "damaged.palp", "--open"}, 2, {"damaged.palp", "checksum"}},
      {{"bench", "box.palp", "--ticks", "10"}, 1, {"--ticks"}},
      {{"bench", "box.palp", "--open", "--bytes", "1e10"}, 1, {"--bytes"}},
  };
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.arguments[0] + " " + bad.arguments[1]);
    expect_failure(run(bad.arguments), bad.code, bad.cause);
  }
}

}  // namespace
}  // namespace palpate::test
