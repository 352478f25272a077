// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/schema.hpp"

namespace clearway::config::internal {

template <typename Struct>
[[nodiscard]] Element Bind(Struct& object, std::string path);

/// The visitor that a config struct's Visit() is called with: turns its entries into the members of
/// an element. Names and help texts must be string literals (only their addresses are kept).
///
/// A default outside its own bounds (NaN, say) makes the value required: the file must give it.
/// Throws std::logic_error on a mistake in the struct: a name that is used twice, that is not
/// lower_snake_case or is reserved, bounds in the wrong order, an enum value without a name.
class Binder {
 public:
  explicit Binder(Element& element) : element_(element) {}

  void Number(const char* name, double& field, double lo, double hi, const char* help);
  void Integer(const char* name, int& field, int lo, int hi, const char* help);
  /// Degrees in the XML, radians in the struct.
  void Degrees(const char* name, double& field_rad, double lo_deg, double hi_deg, const char* help);
  /// Milliseconds in the XML (0.001 is the least step), microseconds in the struct.
  void Milliseconds(const char* name,
                    std::int64_t& field_us,
                    double lo_ms,
                    double hi_ms,
                    const char* help);
  /// true or false, nothing else.
  void Flag(const char* name, bool& field, const char* help);
  /// Any text without control characters, also the empty one.
  void Text(const char* name, std::string& field, const char* help);

  /// One of the names; `names` is iterable over pairs of name and enum value.
  template <typename Enum, typename Names = std::initializer_list<std::pair<const char*, Enum>>>
  void Choice(const char* name, Enum& field, const Names& names, const char* help);

  /// A nested element, at most once in the file.
  template <typename Struct>
  void Group(const char* name, Struct& field, const char* help);

  /// A repeated element. Those in the file replace the default list; without any it stays.
  template <typename Struct>
  void List(const char* name, std::vector<Struct>& field, const char* help);

 private:
  /// A choice without the enum's type: index into the names.
  struct ErasedChoice {
    std::vector<std::string_view> names;
    std::function<std::size_t()> get_index;  ///< names.size() when the value has no name.
    std::function<void(std::size_t)> set_index;
  };

  void AddChoice(const char* name, ErasedChoice choice, const char* help);
  void AddValue(Value value);
  void AddChild(Child child);
  void CheckName(std::string_view name) const;

  Element& element_;
};

template <typename Enum, typename Names>
void Binder::Choice(const char* name, Enum& field, const Names& names, const char* help) {
  ErasedChoice choice;
  std::vector<Enum> values;
  for (const auto& [text, value] : names) {
    choice.names.emplace_back(text);
    values.push_back(value);
  }
  choice.get_index = [&field, values] {
    std::size_t index = 0;
    while (index < values.size() && values[index] != field) ++index;
    return index;
  };
  choice.set_index = [&field, values](std::size_t index) { field = values[index]; };
  AddChoice(name, std::move(choice), help);
}

template <typename Struct>
void Binder::Group(const char* name, Struct& field, const char* help) {
  Child child{
      .name = name, .help = help, .is_list = false, .items = {}, .reset = {}, .make_prototype = {}};
  child.items.push_back(Bind(field, JoinPath(element_.path, name)));
  AddChild(std::move(child));
}

template <typename Struct>
void Binder::List(const char* name, std::vector<Struct>& field, const char* help) {
  const std::string path = JoinPath(element_.path, name);
  const auto bind_items = [&field, path] {
    std::vector<Element> items;
    for (std::size_t i = 0; i < field.size(); ++i)
      items.push_back(Bind(field[i], ItemPath(path, i)));
    return items;
  };
  Child child{.name = name,
              .help = help,
              .is_list = true,
              .items = bind_items(),
              .reset = {},
              .make_prototype = {}};
  child.reset = [&field, bind_items](std::size_t count) {
    field.assign(count, Struct{});
    return bind_items();
  };
  child.make_prototype = [path] {
    const auto object = std::make_shared<Struct>();
    Element prototype = Bind(*object, path);
    prototype.owner = object;
    return prototype;
  };
  AddChild(std::move(child));
}

/// The element of `object`, which must outlive it. Detects `Validate()`. Degrees are set to the
/// radians that their printed text means, which may change the last bit.
template <typename Struct>
Element Bind(Struct& object, std::string path) {
  Element element;
  element.path = std::move(path);
  Binder binder(element);
  Struct::Visit(object, binder);
  if constexpr (requires { std::as_const(object).Validate(); }) {
    element.validate = [&object]() -> std::vector<std::string> {
      return std::as_const(object).Validate();
    };
  }
  return element;
}

}  // namespace clearway::config::internal
