// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/table.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <map>

namespace clearway {
namespace {

using core::procman::Change;
using core::procman::CommandView;
using core::procman::DeputyView;
using core::procman::Snapshot;

using Row = std::vector<std::string>;

constexpr std::int64_t kSecondUs = 1'000'000;
constexpr double kMebi = 1024.0 * 1024.0;

// Characters, not bytes; each is taken to be one column wide.
std::size_t WidthOf(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

// Columns are as wide as they need to be, and two blanks apart.
std::string Aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths;
  for (const Row& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], WidthOf(row[i]));
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i] + std::string(widths[i] - WidthOf(row[i]) + 2, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += (text.empty() ? "" : "\n") + line;
  }
  return text;
}

std::string Format(const char* format, double value) {
  std::array<char, 64> text{};
  (void)std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

std::string Seconds(std::int64_t us) {
  if (us < 0) return "-";
  const double s = static_cast<double>(us) / kSecondUs;
  if (s < 100.0) return Format("%.1f s", s);
  if (s < 6000.0) return Format("%.0f min", s / 60.0);
  return Format("%.1f h", s / 3600.0);
}

std::string Mebibytes(std::int64_t bytes) {
  return Format("%.0f MiB", static_cast<double>(bytes) / kMebi);
}

std::string Joined(std::string text, const std::string& more) {
  if (!more.empty()) text += (text.empty() ? "" : "; ") + more;
  return text;
}

Row RowOf(const DeputyView& deputy) {
  const bool has_memory = deputy.phys_mem_total_bytes > 0;
  return {Printable(deputy.id),
          deputy.is_heard     ? "heard"
          : deputy.age_us < 0 ? "not heard"
                              : "silent",
          Seconds(deputy.age_us),
          deputy.cpu_load < 0.0F ? "-" : Format("%.0f %%", 100.0 * deputy.cpu_load),
          has_memory ? Mebibytes(deputy.phys_mem_free_bytes) + " free of " +
                           Mebibytes(deputy.phys_mem_total_bytes)
                     : "-",
          deputy.version.empty() ? "-" : Printable(deputy.version),
          deputy.config_digest.empty() ? "-" : Printable(deputy.config_digest).substr(0, 12),
          Printable(deputy.text)};
}

Row RowOf(const CommandView& command) {
  const bool is_up = command.pid != 0;
  return {Printable(command.id) + (command.is_stray ? " (copy)" : ""),
          command.group.empty() ? "-" : Printable(command.group),
          Printable(command.deputy),
          std::string(core::procman::WordsFor(command.status)),
          is_up ? std::to_string(command.pid) : "-",
          command.starts < 0 ? "-" : std::to_string(command.starts),
          is_up ? Format("%.1f %%", 100.0 * command.cpu_usage) : "-",
          is_up ? Mebibytes(command.mem_rss_bytes) : "-",
          Seconds(is_up ? command.running_us : -1),
          Printable(Joined(command.text, command.differs))};
}

}  // namespace

std::string Printable(std::string_view text) {
  std::string printable(text);
  for (char& c : printable) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) c = '?';
  }
  return printable;
}

std::string StatusTable(const Snapshot& snapshot) {
  std::vector<Row> deputies = {
      {"DEPUTY", "STATE", "AGE", "LOAD", "MEMORY", "VERSION", "CONFIG", "REMARKS"}};
  for (const DeputyView& deputy : snapshot.deputies) deputies.push_back(RowOf(deputy));
  std::vector<Row> commands = {
      {"COMMAND", "GROUP", "DEPUTY", "STATUS", "PID", "STARTS", "CPU", "MEMORY", "UP", "REMARKS"}};
  for (const CommandView& command : snapshot.commands) commands.push_back(RowOf(command));
  std::string text = Aligned(deputies) + "\n\n" + Aligned(commands);
  if (snapshot.other) {
    text += "\n\nsheriff " + Printable(snapshot.other->id) + " gives orders, the last " +
            Seconds(snapshot.other->age_us) + " ago";
  }
  return text;
}

std::string Summary(const core::procman::Deployment& deployment) {
  std::map<std::string, int> deputies;
  for (const auto& command : deployment.commands) ++deputies[command.deputy];
  std::string text = deployment.file + ": " + std::to_string(deployment.commands.size()) +
                     " commands, " + std::to_string(deployment.scripts.size()) + " scripts";
  for (const auto& [deputy, commands] : deputies) {
    text += "\ndeputy " + Printable(deputy) + ": " + std::to_string(commands) + " commands";
  }
  for (const auto& script : deployment.scripts) {
    text += "\nscript " + Printable(script.name) + ": " + std::to_string(script.actions.size()) +
            " actions";
  }
  return text;
}

std::string IsoTime(std::int64_t utime) {
  const std::time_t seconds = utime / kSecondUs;
  std::tm fields{};
  if (utime < 0 || gmtime_r(&seconds, &fields) == nullptr) return std::to_string(utime);
  std::array<char, 32> text{};
  (void)std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &fields);
  std::array<char, 8> fraction{};
  (void)std::snprintf(
      fraction.data(), fraction.size(), ".%03d", static_cast<int>(utime % kSecondUs / 1000));
  return std::string(text.data()) + fraction.data() + "Z";
}

std::string ChangeLine(const Change& change) {
  const std::string time = IsoTime(change.utime) + " " + Printable(change.deputy);
  const std::string remark = change.text.empty() ? "" : " (" + Printable(change.text) + ")";
  switch (change.kind) {
    case Change::Kind::kSheriff:
      return time + ": orders come from " + Printable(change.to) +
             (change.from.empty() ? "" : ", no more from " + Printable(change.from));
    case Change::Kind::kDeputy:
      return time + ": " + change.to + remark;
    case Change::Kind::kCommand:
      break;
  }
  return time + " " + Printable(change.command) + ": " + change.from + " -> " +
         (change.to.empty() ? "gone" : change.to) + remark;
}

}  // namespace clearway
