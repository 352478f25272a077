// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/config/binder.hpp"
#include "common/config/config_error.hpp"
#include "common/config/reader.hpp"
#include "common/config/writer.hpp"

/// XML file -> config structs.
///
/// A config struct has in-class defaults and `template <typename Self, typename Visitor> static
/// void Visit(Self&, Visitor&)`, which lists its fields (see internal::Binder for the entries), and
/// may have `std::vector<std::string> Validate() const`, one sentence for each broken rule between
/// fields. The root struct stands for `<clearway version="1">`; it is default-constructible and
/// copyable.
///
/// Nothing is mended in silence: unknown names, repeated elements, bad or out-of-range numbers and
/// stray text are errors, and all errors of a file are told in one ConfigError. A rule between
/// fields is judged only when the values of its element and of those inside it are sound.
namespace clearway::config {

/// A configuration and where its values came from.
template <typename Root>
struct LoadResult {
  Root root;
  internal::Origins origins;  ///< Path -> "config/site.xml:41" or "--set"; else it is a default.
};

/// As Load(), from XML text; `file` is what problems call it.
template <typename Root>
[[nodiscard]] LoadResult<Root> Parse(const std::string& text,
                                     const std::string& file,
                                     std::span<const std::string> overrides = {}) {
  LoadResult<Root> result;
  internal::Element root = internal::Bind(result.root, {});
  result.origins = internal::Fill(root, {.file = file, .text = text}, overrides);
  return result;
}

/// Reads the file, then applies the overrides (`element.attribute=value`; the item of a list is
/// `sensor[0].x_m=1`), then judges the rules between fields: an override can mend the file.
/// Throws ConfigError, with all problems, when anything is wrong.
template <typename Root>
[[nodiscard]] LoadResult<Root> Load(const std::filesystem::path& file,
                                    std::span<const std::string> overrides = {}) {
  const internal::Source source = internal::ReadSource(file);
  return Parse<Root>(source.text, source.file, overrides);
}

/// One line a value, in the order of Visit(): `preprocessor.voxel_grid.leaf_m = 0.05  # default`.
/// Without the comment each line is a legal override. Values are in the units of the XML.
template <typename Root>
[[nodiscard]] std::string Print(const LoadResult<Root>& result) {
  Root copy = result.root;
  return internal::PrintValues(internal::Bind(copy, {}), result.origins);
}

struct XmlOptions {
  bool with_help = false;  ///< Comments: help, range and default of each attribute.
};

/// A complete XML file that loads to the same values.
/// @pre All values are within their bounds; no list is empty whose default is not (the file has no
/// way to say so).
template <typename Root>
[[nodiscard]] std::string ToXml(const Root& root, const XmlOptions& options = {}) {
  Root copy = root;
  Root defaults{};
  const internal::Element defaults_element = internal::Bind(defaults, {});
  return internal::WriteXml(internal::Bind(copy, {}),
                            options.with_help ? &defaults_element : nullptr);
}

/// 16 hexadecimal digits: FNV-1a, 64 bits, over paths and values in the order of Visit(). Does not
/// depend on the file's layout or on which values were given in it.
template <typename Root>
[[nodiscard]] std::string Digest(const Root& root) {
  Root copy = root;
  return internal::ComputeDigest(internal::Bind(copy, {}));
}

/// Markdown: one table for each element, with type, range, default, unit and help of its
/// attributes. The defaults shown are the values of `root`.
template <typename Root>
[[nodiscard]] std::string Reference(const Root& root) {
  Root copy = root;
  return internal::WriteReference(internal::Bind(copy, {}));
}

}  // namespace clearway::config
