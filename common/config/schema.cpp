// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/schema.hpp"

#include "common/config/values.hpp"

namespace clearway::config::internal {
namespace {

template <typename Kind>
Kind* Find(Element& element, std::string_view name) {
  for (Member& member : element.members) {
    Kind* const found = std::get_if<Kind>(&member);
    if (found != nullptr && found->name == name) return found;
  }
  return nullptr;
}

template <typename Kind>
std::vector<std::string_view> Names(const Element& element) {
  std::vector<std::string_view> names;
  for (const Member& member : element.members) {
    if (const Kind* const found = std::get_if<Kind>(&member)) names.push_back(found->name);
  }
  return names;
}

}  // namespace

Value* FindValue(Element& element, std::string_view name) {
  return Find<Value>(element, name);
}
Child* FindChild(Element& element, std::string_view name) {
  return Find<Child>(element, name);
}
std::vector<std::string_view> ValueNames(const Element& element) {
  return Names<Value>(element);
}
std::vector<std::string_view> ChildNames(const Element& element) {
  return Names<Child>(element);
}

std::string JoinPath(std::string_view path, std::string_view name) {
  if (path.empty()) return std::string(name);
  return std::string(path) + "." + std::string(name);
}

std::string ItemPath(std::string_view path, std::size_t index) {
  return std::string(path) + "[" + std::to_string(index) + "]";
}

std::string ShownPath(std::string_view path) {
  std::string shown = "<";
  for (const char c : path.empty() ? kRootName : path) {
    if (c == '.') {
      shown += "><";
    } else {
      shown += c;
    }
  }
  return shown + ">";
}

std::string DescribeDefault(const Value& value) {
  if (value.is_required) return " (no default)";
  return Concat({" (default ", PrintedText(value, value.default_text), ")"});
}

std::string DescribeExpected(const Value& value) {
  return Concat({"expected ", value.expected, DescribeDefault(value)});
}

std::string PrintedText(const Value& value, const std::string& text) {
  return value.is_text ? Quote(text) : text;
}

void ForEachValue(const Element& element, const ValueVisitor& visit) {
  for (const Member& member : element.members) {
    if (const Value* const value = std::get_if<Value>(&member)) {
      visit(JoinPath(element.path, value->name), *value);
      continue;
    }
    for (const Element& item : std::get<Child>(member).items) ForEachValue(item, visit);
  }
}

}  // namespace clearway::config::internal
