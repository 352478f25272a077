// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// The tree of elements and values behind a config struct, without the struct's type. It refers to
/// the struct's fields, so it must not outlive the struct.
namespace clearway::config::internal {

inline constexpr std::string_view kRootName = "clearway";
inline constexpr std::string_view kVersionName = "version";
inline constexpr std::string_view kVersion = "1";

/// One attribute and the field it is bound to. Texts are in the units of the XML.
struct Value {
  std::string_view name;
  std::string_view help;
  std::string expected;                         ///< "a number in [0.005, 2]".
  std::function<std::string()> read;            ///< The field as text.
  std::function<bool(std::string_view)> write;  ///< False: refused, the field is unchanged.
  bool is_text = false;                         ///< Printed in quotes.
  std::string default_text;                     ///< The field as text when it was bound.
  bool is_required = false;                     ///< The default is not a legal value.
  std::string origin;                           ///< Empty: default.
};

struct Element;

/// A nested element (exactly one item) or a repeated one (any number).
struct Child {
  std::string_view name;
  std::string_view help;
  bool is_list = false;
  std::vector<Element> items;
  /// Lists only: the vector becomes `count` default-constructed items; returns their elements.
  std::function<std::vector<Element>(std::size_t count)> reset;
  /// Lists only: a default-constructed item that belongs to the element itself.
  std::function<Element()> make_prototype;
};

using Member = std::variant<Value, Child>;

/// One element; its members are in the order of Visit().
struct Element {
  std::string path;  ///< `preprocessor.voxel_grid`, `sensor[0]`; empty for the root.
  std::vector<Member> members;
  std::function<std::vector<std::string>()> validate;  ///< May be empty.
  std::shared_ptr<void> owner;                         ///< Set when the struct belongs to this.
  int line = 0;                                        ///< 0: not in the file.
};

[[nodiscard]] Value* FindValue(Element& element, std::string_view name);
[[nodiscard]] Child* FindChild(Element& element, std::string_view name);
[[nodiscard]] std::vector<std::string_view> ValueNames(const Element& element);
[[nodiscard]] std::vector<std::string_view> ChildNames(const Element& element);

/// `preprocessor.voxel_grid` and `leaf_m` -> `preprocessor.voxel_grid.leaf_m`.
[[nodiscard]] std::string JoinPath(std::string_view path, std::string_view name);

/// `sensor` and 0 -> `sensor[0]`.
[[nodiscard]] std::string ItemPath(std::string_view path, std::size_t index);

/// `preprocessor.voxel_grid` -> `<preprocessor><voxel_grid>`; the root's empty path ->
/// `<clearway>`.
[[nodiscard]] std::string ShownPath(std::string_view path);

/// ` (default 0.05)` or ` (no default)`.
[[nodiscard]] std::string DescribeDefault(const Value& value);

/// `expected a number in [0.005, 2] (default 0.05)`.
[[nodiscard]] std::string DescribeExpected(const Value& value);

/// As `--print-config` and `--set` write it: text in quotes, all else plain.
[[nodiscard]] std::string PrintedText(const Value& value, const std::string& text);

/// Calls visit(path, value) for each value, depth first, in the order of Visit().
using ValueVisitor = std::function<void(const std::string& path, const Value& value)>;
void ForEachValue(const Element& element, const ValueVisitor& visit);

}  // namespace clearway::config::internal
