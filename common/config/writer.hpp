// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/config/reader.hpp"
#include "common/config/schema.hpp"

namespace clearway::config::internal {

[[nodiscard]] std::string PrintValues(const Element& root, const Origins& origins);

/// `defaults`: null, or the element of a default-constructed struct of the same type, whose values
/// then stand in the comments.
[[nodiscard]] std::string WriteXml(const Element& root, const Element* defaults);

[[nodiscard]] std::string ComputeDigest(const Element& root);

[[nodiscard]] std::string WriteReference(const Element& root);

}  // namespace clearway::config::internal
