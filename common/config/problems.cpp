// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/problems.hpp"

#include <algorithm>
#include <utility>

#include "common/config/values.hpp"

namespace clearway::config::internal {
namespace {

std::string DescribePlace(const Element& element, const std::string& file) {
  const std::string line = element.line > 0 ? std::to_string(element.line) : "default";
  return file + ":" + line + ": " + ShownPath(element.path);
}

/// Calls visit(element) for the element and all below it, outer ones first.
template <typename Visit>
void ForEachElement(const Element& element, const Visit& visit) {
  visit(element);
  for (const Member& member : element.members) {
    const Child* const child = std::get_if<Child>(&member);
    if (child == nullptr) continue;
    for (const Element& item : child->items) ForEachElement(item, visit);
  }
}

Problem MakeProblem(const Element& element, std::string text) {
  return {.line = element.line > 0 ? element.line : kNoLine,
          .element = element.path,
          .value = {},
          .text = std::move(text)};
}

}  // namespace

void Problems::Mend(const std::string& value) {
  std::erase_if(problems_, [&value](const Problem& problem) { return problem.value == value; });
}

bool Problems::Concern(const std::string& value) const {
  return std::any_of(problems_.begin(), problems_.end(), [&value](const Problem& problem) {
    return problem.value == value;
  });
}

std::set<std::string> Problems::BrokenElements() const {
  std::set<std::string> broken;
  for (const Problem& problem : problems_) {
    broken.insert("");
    for (std::size_t end = 0; end != std::string::npos;) {
      end = problem.element.find('.', end + 1);
      broken.insert(problem.element.substr(0, end));
    }
  }
  return broken;
}

std::vector<std::string> Problems::Texts() const {
  std::vector<Problem> sorted = problems_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Problem& a, const Problem& b) {
    return a.line < b.line;
  });
  std::vector<std::string> texts;
  for (Problem& problem : sorted) texts.push_back(std::move(problem.text));
  return texts;
}

void CheckRules(const Element& root, const std::string& file, Problems& problems) {
  ForEachElement(root, [&](const Element& element) {
    for (const Member& member : element.members) {
      const Value* const value = std::get_if<Value>(&member);
      if (value == nullptr || !value->is_required || !value->origin.empty()) continue;
      if (problems.Concern(JoinPath(element.path, value->name))) continue;
      problems.Add(MakeProblem(element,
                               DescribePlace(element, file) + " needs the attribute " +
                                   std::string(value->name) + ": " + DescribeExpected(*value)));
    }
  });
  const std::set<std::string> broken = problems.BrokenElements();
  ForEachElement(root, [&](const Element& element) {
    if (!element.validate || broken.contains(element.path)) return;
    for (const std::string& sentence : element.validate()) {
      problems.Add(MakeProblem(element, DescribePlace(element, file) + ": " + sentence));
    }
  });
}

}  // namespace clearway::config::internal
