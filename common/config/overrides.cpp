// SPDX-License-Identifier: BSD-3-Clause
#include "common/config/overrides.hpp"

#include <optional>
#include <string_view>
#include <utility>

#include "common/config/names.hpp"
#include "common/config/values.hpp"

namespace clearway::config::internal {
namespace {

/// One part of a path: `sensor[0]` or `preprocessor`.
struct Step {
  std::string_view name;
  std::optional<int> index;
};

std::optional<Step> ParseStep(std::string_view text) {
  const std::size_t open = text.find('[');
  if (open == std::string_view::npos) return Step{.name = text, .index = {}};
  if (text.back() != ']') return std::nullopt;
  const std::optional<int> index = ParseInteger(text.substr(open + 1, text.size() - open - 2));
  if (!index || *index < 0) return std::nullopt;
  return Step{.name = text.substr(0, open), .index = index};
}

/// One --set, followed from the root to its value.
class Override {
 public:
  Override(std::string_view text, Problems& problems) : text_(text), problems_(problems) {}

  void Apply(Element& root) {
    const std::size_t equals = text_.find('=');
    if (equals == std::string_view::npos) return Fail(root, "expected element.attribute=value");
    std::string_view path = Trim(text_.substr(0, equals));
    Element* element = &root;
    for (std::size_t dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
      element = Descend(*element, path.substr(0, dot));
      if (element == nullptr) return;
      path.remove_prefix(dot + 1);
    }
    Set(*element, path, Trim(text_.substr(equals + 1)));
  }

 private:
  void Fail(const Element& element, const std::string& reason) {
    problems_.Add({.line = kNoLine,
                   .element = element.path,
                   .value = {},
                   .text = "--set " + Shown(text_) + ": " + reason});
  }

  /// The element that the part of the path leads to, or null after a problem was told.
  Element* Descend(Element& element, std::string_view part) {
    const std::optional<Step> step = ParseStep(part);
    Child* const child = step ? FindChild(element, step->name) : nullptr;
    if (child == nullptr) {
      const std::string_view name = step ? step->name : part;
      Fail(element,
           ShownPath(element.path) + " has " +
               DescribeUnknown("element", name, ChildNames(element)));
      return nullptr;
    }
    const std::string name(child->name);
    if (child->is_list != step->index.has_value()) {
      Fail(element,
           child->is_list ? "<" + name + "> is a list: write " + name + "[0] for its first element"
                          : "<" + name + "> is not a list: write it without an index");
      return nullptr;
    }
    const auto index = static_cast<std::size_t>(step->index.value_or(0));
    if (index < child->items.size()) return &child->items[index];
    Fail(element,
         "there is no " + ItemPath(name, index) + ": number of <" + name + "> elements is " +
             std::to_string(child->items.size()));
    return nullptr;
  }

  void Set(Element& element, std::string_view name, std::string_view text) {
    Value* const value = FindValue(element, name);
    if (value == nullptr) {
      return Fail(element,
                  ShownPath(element.path) + " has " +
                      DescribeUnknown("attribute", name, ValueNames(element)));
    }
    const bool is_quoted = value->is_text && !text.empty() && text.front() == '"';
    const std::optional<std::string> plain = is_quoted ? Unquote(text) : std::string(text);
    if (!plain || !value->write(*plain)) return Fail(element, DescribeExpected(*value));
    value->origin = "--set";
    problems_.Mend(JoinPath(element.path, name));
  }

  std::string_view text_;
  Problems& problems_;
};

}  // namespace

void ApplyOverrides(std::span<const std::string> overrides, Element& root, Problems& problems) {
  for (const std::string& text : overrides) Override(text, problems).Apply(root);
}

}  // namespace clearway::config::internal
