// SPDX-License-Identifier: GPL-3.0-or-later
// Results are not written over what they are made of, nor over each other, whatever the way to the file.
#include "tests/cli/palpate_program.hpp"
#include "tests/support/response_samples.hpp"

#include <map>

namespace palpate::test {
namespace {

using Arguments = std::vector<std::string>;

class Overwrite : public PalpateProgram {
protected:
  void SetUp() override {
    write("body.off",
          "OFF\n8 12 0\n-.03 -.03 0\n.03 -.03 0\n-.03 .03 0\n.03 .03 0\n-.03 -.03 .02\n.03 -.03 .02\n-.03 .03 .02\n"
          ".03 .03 .02\n3 0 2 1\n3 1 2 3\n3 4 5 6\n3 5 7 6\n3 0 1 4\n3 1 5 4\n3 2 6 3\n3 3 6 7\n3 0 4 2\n3 2 4 6\n"
          "3 1 3 5\n3 3 7 5\n");
    write("scene.toml", "[body]\nsurface = \"body.off\"\n[sampling]\nspacing = 0.02\ndepth = 0.002\n");
    write("press.csv", "site,dx,dy,dz,fx,fy,fz\n0,0,0,-0.001,0,0,1\n");
    write("motion.csv", "t,x,y,z,qw,qx,qy,qz\n0,0,0,0.05,1,0,0,0\n0.01,0,0,0.05,1,0,0,0\n");
    write_response_file(folder() / "ball.palp", encode(ball_content()));
    std::filesystem::create_symlink("motion.csv", folder() / "link.csv");
    std::filesystem::create_directory(folder() / "scene.work");
    write("scene.work/samples.journal", "samples");
  }

  void expect_refused(const Arguments& arguments, const std::vector<std::string>& names) const {
    SCOPED_TRACE(arguments[0] + " " + arguments[1]);
    expect_failure(run(arguments), 1, names);
  }
};

TEST_F(Overwrite, NothingThatIsRead) {
  std::map<std::string, std::string> before;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder())) {
    if (entry.is_regular_file()) before[entry.path().string()] = file_content(entry.path());
  }
  for (const char* command : {"fit", "build"}) {
    for (const char* input : {"scene.toml", "body.off", "./scene.work/../body.off"}) {
      expect_refused({command, "scene.toml", "-o", input}, {input, "written over"});
    }
    expect_refused({command, "scene.toml", "-o", "scene.work/samples.journal"}, {"samples.journal"});
    // Not there yet, and two names of it.
    expect_refused({command, "scene.toml", "-o", "scene.work/bake.json"}, {"bake.json"});
    expect_refused({command, "scene.toml", "--work", "new", "-o", "./new/manifest.json"}, {"manifest.json"});
  }
  expect_refused({"fit", "scene.toml", "--measured", "press.csv", "-o", "press.csv"}, {"press.csv"});
  for (const char* option : {"--out", "--plot"}) {
    expect_refused({"play", "ball.palp", "motion.csv", option, "motion.csv"}, {"motion.csv"});
    expect_refused({"play", "ball.palp", "motion.csv", option, "link.csv"}, {"link.csv", "motion.csv"});
    expect_refused({"play", "ball.palp", "motion.csv", option, "ball.palp"}, {"ball.palp"});
  }
  for (const char* option : {"--curves", "--glb", "--vtu"}) {
    expect_refused({"export", "ball.palp", option, "ball.palp"}, {"ball.palp"});
  }
  expect_refused({"verify", "scene.toml", "--count", "1", "--report", "scene.toml"}, {"scene.toml"});
  expect_refused({"verify", "scene.toml", "--count", "1", "--report", "body.off"}, {"body.off"});
  expect_refused({"verify", "scene.toml", "--slide", "--report", "body.off"}, {"body.off"});
  expect_refused({"verify", "scene.toml", "--report", "scene.work/samples.journal"}, {"samples.journal"});
  for (const std::vector<std::string>& kind :
       std::vector<std::vector<std::string>>{{"--slide"}, {"--two-tips"}, {"--shape"}, {"--together", "2"}}) {
    for (const char* input : {"scene.toml", "scene.palp", "scene.work/samples.journal"}) {
      Arguments arguments{"verify", "scene.toml", "--report", input};
      arguments.insert(arguments.end(), kind.begin(), kind.end());
      expect_refused(arguments, {input, "written over"});
    }
  }
  for (const char* input : {"scene.toml", "body.off", "scene.palp", "scene.work/samples.journal"}) {
    expect_refused({"verify", "scene.toml", "--plot", input}, {input, "written over"});
    expect_refused({"plan", "scene.toml", "--plot", input}, {input, "written over"});
    expect_refused({"export", "scene.toml", "--solved", input}, {input, "written over"});
    if (listed_commands().count("report") == 0) continue;
    expect_refused({"report", "scene.toml", "--quick", "--page", input}, {input, "written over"});
    expect_refused({"report", "scene.toml", "--quick", "--numbers", input}, {input, "written over"});
    write("other.toml", file_content(folder() / "scene.toml"));
    expect_refused({"report", "other.toml", "--verify", "press.csv", "--beside", "scene.toml", "--page", input},
                   {input, "written over"});
  }
  expect_refused({"verify", "ball.palp", "--samples", "a.json", "--report", "ball.palp"}, {"ball.palp"});
  if (listed_commands().count("drive") != 0) {
    for (const char* option : {"--record", "--plot"}) {
      expect_refused({"drive", "ball.palp", "--device", "sim", "--seconds", "1", option, "ball.palp"}, {"ball.palp"});
    }
  }
  for (const auto& [file, content] : before) EXPECT_EQ(file_content(file), content) << file;
}

TEST_F(Overwrite, NoOtherResult) {
  expect_refused({"play", "ball.palp", "motion.csv", "--out", "a", "--plot", "./a"}, {"./a", "another result"});
  expect_refused({"export", "ball.palp", "--curves", "a", "--vtu", "a"}, {"a: would be written over a"});
  EXPECT_FALSE(std::filesystem::exists(folder() / "a"));
  // A device takes both.
  EXPECT_EQ(run({"play", "ball.palp", "motion.csv", "--out", "/dev/null", "--plot", "/dev/null"}).exit_code, 0);
  EXPECT_EQ(run({"play", "ball.palp", "motion.csv", "--out", "a", "--plot", "b"}).exit_code, 0);
}

TEST_F(Overwrite, NoFileByAProposal) {
  std::filesystem::create_directory(folder() / "organs");
  write("organs/liver.off", file_content(folder() / "body.off"));
  const Arguments proposal{"scene", "--from", "organs", "--out", "proposed file.toml"};
  const RunResult first = run(proposal);
  ASSERT_EQ(first.exit_code, 0) << first.error;
  EXPECT_NE(first.error.find("palpate mesh 'proposed file.toml'"), std::string::npos) << first.error;
  write("proposed file.toml", "# edited\n");
  expect_refused(proposal, {"proposed file.toml: exists", "--out"});
  EXPECT_EQ(file_content(folder() / "proposed file.toml"), "# edited\n");
  const std::string organ = file_content(folder() / "organs/liver.off");
  expect_refused({"scene", "--from", "organs", "--out", "organs/liver.off"}, {"organs/liver.off: exists"});
  EXPECT_EQ(file_content(folder() / "organs/liver.off"), organ);
}

TEST_F(Overwrite, NoSurfaceOfTheSceneThatMeshWouldReplace) {
  ASSERT_EQ(run({"mesh", "scene.toml", "--out", "."}).exit_code, 0);  // body.off, not body.ply
  const std::string surface = file_content(folder() / "body.ply");
  write("scene.toml", "[body]\nsurface = \"body.ply\"\nunits = \"mm\"\n");
  expect_refused({"mesh", "scene.toml", "--out", "."}, {"./body.ply", "which is read"});
  EXPECT_EQ(file_content(folder() / "body.ply"), surface);
}

}  // namespace
}  // namespace palpate::test
