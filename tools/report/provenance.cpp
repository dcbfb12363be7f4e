// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/provenance.hpp"

#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>

#include "formats/io/hash.hpp"
#include "tools/bench/tick_bench.hpp"

namespace palpate::report {
namespace {

using Json = nlohmann::ordered_json;

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts);
  return text;
}

}  // namespace

Json provenance(const pipeline::Pipeline& p, const runtime::View& view,
                const std::vector<std::filesystem::path>& inputs) {
  Json json{{"program", PALPATE_VERSION}, {"file_version", view.header().version}, {"machine", cli::machine_name()},
            {"made", utc_now()},          {"manifest", to_hex(p.manifest)},        {"inputs", Json::array()}};
  std::vector<std::filesystem::path> files = files_of(p.scene);
  files.insert(files.begin(), p.scene.file);
  files.push_back(p.paths.response);
  files.insert(files.end(), inputs.begin(), inputs.end());
  for (const std::filesystem::path& file : files) {
    if (!std::filesystem::exists(file)) continue;
    json["inputs"].push_back({{"file", file.filename().string()},
                              {"bytes", std::filesystem::file_size(file)},
                              {"hash", to_hex(hash_file(file))}});
  }
  const Json baked = Json::parse(std::string(view.provenance, view.provenance_size), nullptr, false);
  json["bake"] = baked.is_discarded() ? Json() : baked;
  return json;
}

}  // namespace palpate::report
