// SPDX-License-Identifier: GPL-3.0-or-later
// The manifest: a plan as JSON, to the bit.
#include <nlohmann/json.hpp>

#include "formats/io/error.hpp"
#include "precompute/bake/plan.hpp"

namespace palpate::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "palpate manifest";
constexpr int kVersion = 1;

Json vector_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Eigen::Vector3d vector_from(const Json& json) {
  if (json.size() != 3) throw Error(ExitCode::bad_input, "a vector has three numbers");
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// The names are those of version 1 for good, because the manifest's hash binds journals to it.
const char* role_name(PairRole role) {
  switch (role) {
    case PairRole::normal:
      return "straight";
    case PairRole::hidden:
      return "hidden";
    default:
      return "full";
  }
}

PairRole role_from(const std::string& name) {
  for (const PairRole r : {PairRole::full, PairRole::normal, PairRole::hidden}) {
    if (name == role_name(r)) return r;
  }
  throw Error(ExitCode::bad_input, "unknown role '" + name + "'; allowed full, straight, hidden");
}

PairPlan pair_from(const Json& json) {
  PairPlan pair;
  pair.site = json.at("site").get<std::uint32_t>();
  pair.tool = json.at("tool").get<std::uint32_t>();
  pair.tool_vertex = json.at("tool_vertex").get<std::uint32_t>();
  pair.frame.origin = vector_from(json.at("origin"));
  pair.frame.x = vector_from(json.at("x"));
  pair.frame.y = vector_from(json.at("y"));
  pair.frame.n = vector_from(json.at("n"));
  pair.depth = json.at("depth").get<double>();
  pair.role = role_from(json.value("role", role_name(PairRole::full)));
  return pair;
}

const char* reason_name(SkipReason reason) {
  switch (reason) {
    case SkipReason::support:
      return "support";
    case SkipReason::unreachable:
      return "unreachable";
    default:
      return "outside";
  }
}

SkipReason reason_from(const std::string& name) {
  for (const SkipReason r : {SkipReason::support, SkipReason::outside, SkipReason::unreachable}) {
    if (name == reason_name(r)) return r;
  }
  throw Error(ExitCode::bad_input, "unknown reason '" + name + "'; allowed support, outside, unreachable");
}

}  // namespace

std::string manifest_text(const Plan& plan) {
  Json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["units"] = "m";
  Json& inputs = json["inputs"];
  inputs["solver"] = plan.inputs.solver;
  inputs["scene"] = to_hex(plan.inputs.scene);
  inputs["body"] = to_hex(plan.inputs.body);
  inputs["haptic_mesh"] = to_hex(plan.inputs.haptic_mesh);
  inputs["tools"] = Json::array();
  for (const Hash128& tool : plan.inputs.tools) inputs["tools"].push_back(to_hex(tool));
  json["pairs"] = Json::array();
  for (const PairPlan& pair : plan.pairs) {
    json["pairs"].push_back(Json{{"site", pair.site},
                                 {"tool", pair.tool},
                                 {"tool_vertex", pair.tool_vertex},
                                 {"origin", vector_json(pair.frame.origin)},
                                 {"x", vector_json(pair.frame.x)},
                                 {"y", vector_json(pair.frame.y)},
                                 {"n", vector_json(pair.frame.n)},
                                 {"depth", pair.depth}});
    if (pair.role != PairRole::full) json["pairs"].back()["role"] = role_name(pair.role);
  }
  json["skipped"] = Json::array();
  for (const SkippedPair& pair : plan.skipped) {
    json["skipped"].push_back(Json{{"site", pair.site},
                                   {"tool", pair.tool},
                                   {"tool_vertex", pair.tool_vertex},
                                   {"reason", reason_name(pair.reason)}});
  }
  return json.dump(1, ' ') + "\n";
}

Manifest parse_manifest(const std::string& text, const std::string& source) {
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != kFormat) throw Error(ExitCode::bad_input, "is not a Palpate manifest");
    if (json.at("version") != kVersion) {
      throw Error(ExitCode::bad_input, "version " + json.at("version").dump() + ", this program reads version 1");
    }
    Manifest manifest;
    const Json& inputs = json.at("inputs");
    manifest.inputs.solver = inputs.at("solver").get<int>();
    manifest.inputs.scene = hash_from_hex(inputs.at("scene").get<std::string>());
    manifest.inputs.body = hash_from_hex(inputs.at("body").get<std::string>());
    manifest.inputs.haptic_mesh = hash_from_hex(inputs.at("haptic_mesh").get<std::string>());
    for (const Json& tool : inputs.at("tools")) manifest.inputs.tools.push_back(hash_from_hex(tool.get<std::string>()));
    for (const Json& pair : json.at("pairs")) manifest.pairs.push_back(pair_from(pair));
    for (const Json& pair : json.at("skipped")) {
      SkippedPair skipped;
      skipped.site = pair.at("site").get<std::uint32_t>();
      skipped.tool = pair.at("tool").get<std::uint32_t>();
      skipped.tool_vertex = pair.at("tool_vertex").get<std::uint32_t>();
      skipped.reason = reason_from(pair.at("reason").get<std::string>());
      manifest.skipped.push_back(skipped);
    }
    return manifest;
  } catch (const Error& error) {
    throw Error(ExitCode::bad_input, source + ": " + error.what());
  } catch (const nlohmann::json::exception& error) {
    throw Error(ExitCode::bad_input, source + ": " + error.what());
  }
}

Hash128 manifest_hash(const std::string& text) { return hash128(text); }

}  // namespace palpate::bake
