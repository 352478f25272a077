// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <string_view>
#include <utility>

#include "common/config/writer.hpp"

namespace clearway::config::internal {
namespace {

/// Longer endings first where one ends in the other.
constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kUnits = {
    {{"_degps2", "deg/s^2"},
     {"_degps", "deg/s"},
     {"_radps2", "rad/s^2"},
     {"_radps", "rad/s"},
     {"_mps2", "m/s^2"},
     {"_mps", "m/s"},
     {"_hz", "Hz"},
     {"_deg", "deg"},
     {"_rad", "rad"},
     {"_bytes", "bytes"},
     {"_px", "px"},
     {"_ms", "ms"},
     {"_us", "us"},
     {"_m2", "m^2"},
     {"_m", "m"},
     {"_s", "s"}}};

std::string_view UnitOf(std::string_view name) {
  for (const auto& [ending, unit] : kUnits) {
    if (name.ends_with(ending)) return unit;
  }
  return "-";
}

/// A text inside a cell of a Markdown table.
std::string ToCell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '<') {
      cell += "&lt;";
      continue;
    }
    if (c == '|' || c == '*' || c == '_') cell += '\\';
    cell += c;
  }
  return cell;
}

std::string DescribeRow(const Value& value) {
  std::string shown = value.default_text.empty() ? "(empty)" : "`" + value.default_text + "`";
  if (value.is_required) shown = "required";
  return "| `" + std::string(value.name) + "` | " + ToCell(value.expected) + " | " + shown + " | " +
         std::string(UnitOf(value.name)) + " | " + ToCell(value.help) + " |\n";
}

std::string Describe(const Element& element, const std::string& heading, std::string_view help) {
  std::string text = "\n## `" + heading + "`\n\n";
  if (!help.empty()) text += ToCell(help) + "\n\n";
  std::string rows;
  std::string nested;
  for (const Member& member : element.members) {
    if (const Value* const value = std::get_if<Value>(&member)) {
      rows += DescribeRow(*value);
      continue;
    }
    const Child& child = std::get<Child>(member);
    const Element item = child.is_list ? child.make_prototype() : child.items.front();
    const std::string path = JoinPath(element.path, child.name);
    nested += Describe(item, ShownPath(path) + (child.is_list ? " (any number)" : ""), child.help);
  }
  if (rows.empty()) return text + "No attributes.\n" + nested;
  return text +
         "| attribute | type and range | default | unit | meaning |\n"
         "|---|---|---|---|---|\n" +
         rows + nested;
}

}  // namespace

std::string WriteReference(const Element& root) {
  const std::string text =
      "# Configuration reference\n\n"
      "Every element and attribute of the XML file. All are optional unless marked as required. "
      "Numbers are decimal, without a leading `+` and without white space.\n";
  return text + Describe(root, "<clearway version=\"1\">", {});
}

}  // namespace clearway::config::internal
