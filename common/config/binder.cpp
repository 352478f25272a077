// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/binder.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "common/config/values.hpp"

namespace clearway::config::internal {
namespace {

std::string DescribeRange(const std::string& kind, double lo, double hi) {
  return kind + " in [" + FormatNumber(lo) + ", " + FormatNumber(hi) + "]";
}

void CheckBounds(std::string_view name, double lo, double hi) {
  if (lo <= hi) return;
  throw std::logic_error("config value " + std::string(name) + ": lower bound above upper bound");
}

Value MakeValue(const char* name, const char* help) {
  Value value;
  value.name = name;
  value.help = help;
  return value;
}

bool IsLowerSnakeCase(std::string_view name) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name.front() >= 'a' && name.front() <= 'z' &&
         std::all_of(name.begin(), name.end(), is_allowed);
}

}  // namespace

void Binder::Number(const char* name, double& field, double lo, double hi, const char* help) {
  CheckBounds(name, lo, hi);
  Value value = MakeValue(name, help);
  value.expected = DescribeRange("a number", lo, hi);
  value.read = [&field] { return FormatNumber(field); };
  value.write = [&field, lo, hi](std::string_view text) {
    const std::optional<double> number = ParseNumber(text);
    if (!number || *number < lo || *number > hi) return false;
    field = *number;
    return true;
  };
  AddValue(std::move(value));
}

void Binder::Integer(const char* name, int& field, int lo, int hi, const char* help) {
  CheckBounds(name, lo, hi);
  Value value = MakeValue(name, help);
  value.expected = "a whole number in [" + std::to_string(lo) + ", " + std::to_string(hi) + "]";
  value.read = [&field] { return std::to_string(field); };
  value.write = [&field, lo, hi](std::string_view text) {
    const std::optional<int> number = ParseInteger(text);
    if (!number || *number < lo || *number > hi) return false;
    field = *number;
    return true;
  };
  AddValue(std::move(value));
}

void Binder::Degrees(const char* name,
                     double& field_rad,
                     double lo_deg,
                     double hi_deg,
                     const char* help) {
  CheckBounds(name, lo_deg, hi_deg);
  Value value = MakeValue(name, help);
  value.expected = DescribeRange("a number", lo_deg, hi_deg);
  value.read = [&field_rad] { return FormatDegrees(field_rad); };
  value.write = [&field_rad, lo_deg, hi_deg](std::string_view text) {
    const std::optional<double> angle_deg = ParseNumber(text);
    if (!angle_deg || *angle_deg < lo_deg || *angle_deg > hi_deg) return false;
    field_rad = ToCanonicalRad(*angle_deg);
    return true;
  };
  AddValue(std::move(value));
}

void Binder::Milliseconds(const char* name,
                          std::int64_t& field_us,
                          double lo_ms,
                          double hi_ms,
                          const char* help) {
  CheckBounds(name, lo_ms, hi_ms);
  Value value = MakeValue(name, help);
  value.expected = DescribeRange("a number", lo_ms, hi_ms) + " in steps of 0.001";
  value.read = [&field_us] { return FormatMilliseconds(field_us); };
  value.write = [&field_us, lo_ms, hi_ms](std::string_view text) {
    const std::optional<std::int64_t> time_us = ParseMilliseconds(text);
    if (!time_us) return false;
    const double time_ms = static_cast<double>(*time_us) / 1000.0;
    if (time_ms < lo_ms || time_ms > hi_ms) return false;
    field_us = *time_us;
    return true;
  };
  AddValue(std::move(value));
}

void Binder::Flag(const char* name, bool& field, const char* help) {
  Value value = MakeValue(name, help);
  value.expected = "true or false";
  value.read = [&field] { return std::string(field ? "true" : "false"); };
  value.write = [&field](std::string_view text) {
    if (text != "true" && text != "false") return false;
    field = text == "true";
    return true;
  };
  AddValue(std::move(value));
}

void Binder::Text(const char* name, std::string& field, const char* help) {
  Value value = MakeValue(name, help);
  value.expected = "text without control characters";
  value.is_text = true;
  value.read = [&field] { return field; };
  value.write = [&field](std::string_view text) {
    if (!IsPlainText(text)) return false;
    field = std::string(text);
    return true;
  };
  AddValue(std::move(value));
}

void Binder::AddChoice(const char* name, ErasedChoice choice, const char* help) {
  Value value = MakeValue(name, help);
  value.expected = "one of";
  for (const std::string_view choice_name : choice.names) {
    value.expected += (choice_name == choice.names.front() ? " " : ", ") + std::string(choice_name);
  }
  value.read = [choice, field_name = value.name] {
    const std::size_t index = choice.get_index();
    if (index < choice.names.size()) return std::string(choice.names[index]);
    throw std::logic_error("config value " + std::string(field_name) + ": enum value has no name");
  };
  value.write = [choice](std::string_view text) {
    const auto found = std::find(choice.names.begin(), choice.names.end(), text);
    if (found == choice.names.end()) return false;
    choice.set_index(static_cast<std::size_t>(found - choice.names.begin()));
    return true;
  };
  AddValue(std::move(value));
}

void Binder::AddValue(Value value) {
  CheckName(value.name);
  value.default_text = value.read();
  value.is_required = !value.write(value.default_text);
  element_.members.emplace_back(std::move(value));
}

void Binder::AddChild(Child child) {
  CheckName(child.name);
  element_.members.emplace_back(std::move(child));
}

void Binder::CheckName(std::string_view name) const {
  const bool is_reserved = element_.path.empty() && name == kVersionName;
  const bool is_taken =
      FindValue(element_, name) != nullptr || FindChild(element_, name) != nullptr;
  if (IsLowerSnakeCase(name) && !is_reserved && !is_taken) return;
  throw std::logic_error("config name " + JoinPath(element_.path, name) +
                         ": used twice, reserved or not lower_snake_case");
}

}  // namespace clearway::config::internal
