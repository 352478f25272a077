// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen_messages.hpp"

#include <array>
#include <ctime>

namespace clearway::screen {
namespace {

using core::procman::Change;

std::string NameOf(const core::procman::Target& target) {
  switch (target.kind) {
    case core::procman::Target::Kind::kCommand:
      return target.name;
    case core::procman::Target::Kind::kGroup:
      return "group " + target.name;
    case core::procman::Target::Kind::kEverything:
      break;
  }
  return "everything";
}

}  // namespace

std::string Clock(std::int64_t utime) {
  const auto seconds = static_cast<std::time_t>(utime / 1'000'000);
  std::tm local{};
  localtime_r(&seconds, &local);
  std::array<char, 16> text{};
  std::strftime(text.data(), text.size(), "%H:%M:%S", &local);
  return text.data();
}

std::string ChangeInWords(const Change& change) {
  std::string text = change.kind == Change::Kind::kCommand ? change.command : change.deputy;
  if (change.kind == Change::Kind::kDeputy) text.insert(0, "host ");
  if (change.kind == Change::Kind::kSheriff) text = "the orders of " + text + " come from";
  text += ": " + change.from + (change.from.empty() ? "" : " -> ") +
          (change.to.empty() ? "gone" : change.to);
  return change.text.empty() ? text : text + ": " + change.text;
}

std::string OrderInWords(const Intent& intent, int commands) {
  std::string what = intent.kind == Intent::Kind::kStart  ? "start "
                     : intent.kind == Intent::Kind::kStop ? "stop "
                                                          : "restart ";
  what += NameOf(intent.target);
  if (intent.target.kind == core::procman::Target::Kind::kCommand) return what;
  return what + " (" + std::to_string(commands) + (commands == 1 ? " command)" : " commands)");
}

}  // namespace clearway::screen
