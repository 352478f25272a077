// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "common/io/read_error.hpp"

namespace clearway::test {

/// The message with which a call refuses its input; empty when it does not.
template <typename Call>
std::string RefusalOf(Call call) {
  try {
    static_cast<void>(call());
  } catch (const io::ReadError& error) {
    return error.what();
  }
  return {};
}

inline bool IsOneLine(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= ' '; });
}

}  // namespace clearway::test
