// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/proc_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

#include "common/host/descriptor.hpp"

namespace clearway::host {

std::string_view ReadProcFile(int folder_fd, const char* name, std::span<char> buffer) {
  const Descriptor file(openat(folder_fd, name, O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return {};
  // The files read this way come in one piece.
  const ssize_t size = read(file.get(), buffer.data(), buffer.size());
  return size <= 0 ? std::string_view{} : std::string_view(buffer.data(), std::size_t(size));
}

std::optional<std::string> ReadProcFile(const std::string& path, std::size_t max_bytes) {
  constexpr std::size_t kStep = 16384;
  const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return std::nullopt;
  std::string content;
  while (content.size() < max_bytes) {
    const std::size_t size = content.size();
    const std::size_t step = std::min(kStep, max_bytes - size);
    content.resize(size + step);
    const ssize_t got = read(file.get(), content.data() + size, step);
    content.resize(size + (got > 0 ? std::size_t(got) : 0));
    if (got < 0 && errno != EINTR) return std::nullopt;
    if (got == 0) break;
  }
  return content;
}

std::string WithReason(const std::string& what) {
  const char* const reason = strerrordesc_np(errno);
  return what + ": " + (reason == nullptr ? "unknown reason" : reason);
}

}  // namespace clearway::host
