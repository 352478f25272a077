// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace clearway::test {

/// How often this program has called operator new. Linking count_allocations.cpp replaces it.
[[nodiscard]] std::size_t NumAllocations();

}  // namespace clearway::test
