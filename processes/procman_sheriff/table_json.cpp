// SPDX-License-Identifier: BSD-3-Clause
// The names below are documented in README.md and do not change.
#include <nlohmann/json.hpp>

#include "common/core/procman/managed_command.hpp"
#include "processes/procman_sheriff/table.hpp"

namespace clearway {
namespace {

using core::procman::Change;
using core::procman::CommandView;
using core::procman::DeputyView;
using core::procman::GroupView;
using core::procman::Snapshot;
using Json = nlohmann::ordered_json;

double Seconds(std::int64_t us) {
  return static_cast<double>(us) / 1e6;
}

// Text from the network may be no UTF-8: what is not becomes U+FFFD instead of an exception.
std::string Dump(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

void AddText(Json& json, const char* name, const std::string& text) {
  if (!text.empty()) json[name] = text;
}

Json ToJson(const DeputyView& deputy) {
  Json json = {{"id", deputy.id},
               {"in_file", deputy.is_in_file},
               {"heard", deputy.is_heard},
               {"tells_health", deputy.tells_health}};
  if (deputy.age_us >= 0) json["age_s"] = Seconds(deputy.age_us);
  AddText(json, "host", deputy.host);
  AddText(json, "version", deputy.version);
  AddText(json, "config_digest", deputy.config_digest);
  AddText(json, "sheriff", deputy.sheriff_id);
  AddText(json, "text", deputy.text);
  if (deputy.cpu_load >= 0.0F) json["cpu_load"] = deputy.cpu_load;
  if (deputy.phys_mem_total_bytes > 0) {
    json["memory_total_bytes"] = deputy.phys_mem_total_bytes;
    json["memory_free_bytes"] = deputy.phys_mem_free_bytes;
    json["swap_total_bytes"] = deputy.swap_total_bytes;
    json["swap_free_bytes"] = deputy.swap_free_bytes;
  }
  json["commands"] = deputy.commands;
  return json;
}

Json ToJson(const GroupView& group) {
  return {{"path", group.path},
          {"commands", group.commands},
          {"ready", group.ready},
          {"up", group.up},
          {"trouble", group.trouble},
          {"unknown", group.unknown}};
}

Json ToJson(const CommandView& command) {
  Json json = {{"id", command.id},
               {"group", command.group},
               {"deputy", command.deputy},
               {"exec", command.exec},
               {"auto_respawn", command.auto_respawn},
               {"in_file", command.is_in_file},
               {"stray", command.is_stray},
               {"status", core::procman::NameOf(command.status)},
               {"ready", command.is_ready}};
  AddText(json, "text", command.text);
  AddText(json, "differs", command.differs);
  json["run_id"] = command.run_id;
  if (command.pid != 0) {
    json["pid"] = command.pid;
    json["cpu_usage"] = command.cpu_usage;
    json["memory_rss_bytes"] = command.mem_rss_bytes;
    json["memory_virtual_bytes"] = command.mem_vsize_bytes;
    if (command.running_us >= 0) json["running_s"] = Seconds(command.running_us);
  } else if (command.run_id != 0) {
    json["wait_status"] = command.exit_code;
    json["exit"] = core::procman::DescribeExit(command.exit_code);
  }
  if (command.starts >= 0) json["starts"] = command.starts;
  if (command.dropped_output_bytes > 0) {
    json["dropped_output_bytes"] = command.dropped_output_bytes;
  }
  return json;
}

template <typename View>
Json ArrayOf(const std::vector<View>& views) {
  Json array = Json::array();
  for (const View& view : views) array.push_back(ToJson(view));
  return array;
}

}  // namespace

std::string StatusJson(const Snapshot& snapshot,
                       const std::string& result,
                       const std::string& text) {
  Json json = {{"result", result}};
  AddText(json, "text", text);
  AddText(json, "file", snapshot.file);
  json["sheriff"] = snapshot.sheriff_id;
  if (snapshot.other) {
    json["other_sheriff"] = {{"id", snapshot.other->id},
                             {"age_s", Seconds(snapshot.other->age_us)}};
  }
  json["deputies"] = ArrayOf(snapshot.deputies);
  json["groups"] = ArrayOf(snapshot.groups);
  json["commands"] = ArrayOf(snapshot.commands);
  return Dump(json, 2);
}

std::string ChangeJson(const Change& change) {
  Json json = {{"utime", change.utime}, {"deputy", change.deputy}};
  switch (change.kind) {
    case Change::Kind::kCommand:
      json["command"] = change.command;
      json["from"] = core::procman::NameOf(change.before);
      json["to"] = change.to.empty() ? "gone" : core::procman::NameOf(change.status);
      break;
    case Change::Kind::kDeputy:
      json["heard"] = change.to == "Heard";
      break;
    case Change::Kind::kSheriff:
      json["sheriff"] = change.to;
      AddText(json, "former_sheriff", change.from);
      break;
  }
  AddText(json, "text", change.text);
  return Dump(json, -1);
}

}  // namespace clearway
